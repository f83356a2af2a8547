#include "bake/handle_solver.h"

#include "core/vector.h"
#include "linear/elimination.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <iterator>
#include <numeric>
#include <thread>

namespace limber::bake {
namespace {

constexpr int kExpectedIterations = 20;  // of one handle, for the progress display only
// The fine answer may reach beyond where the coarse one is above zero, by this share of the way
// across the surface, or a few aggregates where these are large. Where that was too little, twice
// as far is tried, and then all there is.
constexpr double kFurther = 0.08;
constexpr int kFewestRings = 2, kAttempts = 3;
constexpr double kNearlyAll = 0.9;  // of the free vertices: not worth the risk of trying again

}  // namespace

HandleSolver::HandleSolver(const QuadraticProblem& problem, const WeightSupports& supports)
    : problem_(problem),
      supports_(supports),
      order_(linear::EliminateInGoodOrder(problem.Q).new_of_old),
      solutions_(Eigen::MatrixXd::Zero(problem.c.rows(), problem.c.cols())),
      reports_(static_cast<size_t>(problem.c.cols())),
      iterations_(static_cast<size_t>(problem.c.cols())) {}

Status HandleSolver::Run(int num_threads, const ProgressCallback& progress) {
  active_ = std::min(num_threads, static_cast<int>(reports_.size()));
  Vector<std::thread> workers;
  workers.reserve(static_cast<size_t>(active_));
  for (int i = active_; i > 0; --i)
    workers.emplace_back([this] { Work(); });
  Wait(progress);
  for (std::thread& worker : workers)
    worker.join();
  if (cancelled_) return Error(StatusCode::kInvalidArgument, "cancelled");
  if (!failure_.empty())
    return Error(StatusCode::kInternal, "skinning weights: %s", failure_.c_str());
  return {};
}

void HandleSolver::Work() {
  try {
    for (int h = next_++; h < static_cast<int>(reports_.size()) && !cancelled_; h = next_++)
      SolveHandle(h);
  } catch (const std::exception& exception) {
    const std::lock_guard<std::mutex> lock(mutex_);
    failure_ = exception.what();
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  --active_;
  changed_.notify_all();
}

void HandleSolver::SolveHandle(int h) {
  const auto index = static_cast<size_t>(h);
  const auto keep_going = [&] {
    ++iterations_[index];
    changed_.notify_all();
    return !cancelled_;
  };
  BoundedQuadraticReport& report = reports_[index];
  for (int attempt = 0; attempt < kAttempts && !report.converged && !cancelled_; ++attempt) {
    Eigen::VectorXd x;
    report = BoundedQuadratic(problem_.Q, order_, VariablesOf(h, attempt))
                 .Solve(problem_.c.col(h), keep_going, &x);
    solutions_.col(h) = x;
  }
  iterations_[index] = kExpectedIterations;
}

// Those free vertices that the handle may reach, the more the later the attempt.
Vector<int> HandleSolver::VariablesOf(int h, int attempt) const {
  Vector<int> all(problem_.free_vertices.size()), variables;
  std::iota(all.begin(), all.end(), 0);
  if (attempt + 1 == kAttempts) return all;
  const double across = std::sqrt(supports_.num_aggregates());
  const int rings = std::max(kFewestRings, static_cast<int>(std::lround(kFurther * across)));
  const Vector<bool> is_near = supports_.Around(h, rings << attempt);
  std::copy_if(all.begin(), all.end(), std::back_inserter(variables), [&](int i) {
    return is_near[static_cast<size_t>(problem_.free_vertices[static_cast<size_t>(i)])];
  });
  const double enough = kNearlyAll * static_cast<double>(all.size());
  return static_cast<double>(variables.size()) > enough ? all : variables;
}

double HandleSolver::Fraction() const {
  double sum = 0;
  for (const std::atomic<int>& count : iterations_)
    sum += std::min(count.load(), kExpectedIterations);
  return sum / (kExpectedIterations * static_cast<double>(iterations_.size()));
}

void HandleSolver::Wait(const ProgressCallback& progress) {
  double told = 0;
  std::unique_lock<std::mutex> lock(mutex_);
  while (active_ > 0) {
    changed_.wait_for(lock, std::chrono::milliseconds(100));
    const double fraction = Fraction();
    if (!progress || fraction <= told || cancelled_) continue;
    told = fraction;
    lock.unlock();
    if (!progress("weights", fraction)) cancelled_ = true;
    lock.lock();
  }
}

}  // namespace limber::bake
