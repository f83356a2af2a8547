// The bounded biharmonic problems of all handles, solved side by side.
#pragma once

#include "bake/bounded_quadratic.h"
#include "bake/progress.h"
#include "bake/quadratic_problem.h"
#include "bake/weight_supports.h"
#include "core/status.h"
#include "core/vector.h"

#include <Eigen/Core>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>

namespace limber::bake {

// Solves the handles' problems on worker threads, one handle at a time on each. The caller's thread
// only waits and tells of the progress, so that the callback never runs anywhere else.
class HandleSolver {
 public:
  // Keeps references.
  HandleSolver(const QuadraticProblem& problem, const WeightSupports& supports);

  // Each handle's problem has the same bits for any number of threads. Errors: kInvalidArgument
  // ("cancelled"), kInternal (out of memory).
  Status Run(int num_threads, const ProgressCallback& progress);

  const Eigen::MatrixXd& solutions() const { return solutions_; }  // free x H

  const Vector<BoundedQuadraticReport>& reports() const { return reports_; }

 private:
  void Work();
  void SolveHandle(int h);
  Vector<int> VariablesOf(int h, int attempt) const;
  double Fraction() const;
  void Wait(const ProgressCallback& progress);

  const QuadraticProblem& problem_;
  const WeightSupports& supports_;
  Vector<int> order_;  // of elimination
  Eigen::MatrixXd solutions_;
  Vector<BoundedQuadraticReport> reports_;
  Vector<std::atomic<int>> iterations_;
  std::atomic<int> next_ = 0;
  std::atomic<bool> cancelled_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  int active_ = 0;
  std::string failure_;
};

}  // namespace limber::bake
