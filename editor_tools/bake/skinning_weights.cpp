#include "bake/skinning_weights.h"

#include "bake/bounded_quadratic.h"
#include "bake/weight_rows.h"
#include "geometry/robust_laplacian.h"
#include "geometry/union_find.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace limber::bake {
namespace {

using Eigen::MatrixXd;
using Eigen::SparseMatrix;
using Eigen::VectorXd;

constexpr double kNegligibleWeight = 1e-7;  // becomes zero before rows are normalised
constexpr int kExpectedIterations = 20;     // of one handle, for the progress display only

// The problem of all handles, split into free vertices and handle vertices.
struct Split {
  std::vector<int> free_vertices;
  SparseMatrix<double> Q;  // free x free
  MatrixXd c;              // free x H: the pull of each handle's one
};

SparseMatrix<double> BiharmonicForm(const geometry::SolveMesh& mesh) {
  const geometry::RobustLaplacian robust = geometry::MakeRobustLaplacian(mesh);
  // Areas relative to their mean: the form, and so the weights, know no unit of length.
  const VectorXd inverse = (robust.areas / robust.areas.mean()).cwiseInverse();
  const SparseMatrix<double> scaled = inverse.asDiagonal() * robust.laplacian;
  SparseMatrix<double> Q = robust.laplacian * scaled;
  const SparseMatrix<double> transposed = Q.transpose();
  return 0.5 * (Q + transposed);
}

Split SplitProblem(const geometry::SolveMesh& mesh, std::span<const int> handle_vertices) {
  const SparseMatrix<double> Q = BiharmonicForm(mesh);
  const auto num_handles = static_cast<Eigen::Index>(handle_vertices.size());
  std::vector<int> handle_of(static_cast<size_t>(mesh.num_vertices()), -1);
  for (size_t h = 0; h < handle_vertices.size(); ++h) {
    handle_of[handle_vertices[h]] = static_cast<int>(h);
  }
  Split split;
  std::vector<int> row_of(handle_of.size(), -1);
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (handle_of[v] >= 0) continue;
    row_of[v] = static_cast<int>(split.free_vertices.size());
    split.free_vertices.push_back(v);
  }
  const auto num_free = static_cast<Eigen::Index>(split.free_vertices.size());
  split.Q.resize(num_free, num_free);
  split.c = MatrixXd::Zero(num_free, num_handles);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<size_t>(Q.nonZeros()));
  for (int column = 0; column < Q.outerSize(); ++column) {
    for (SparseMatrix<double>::InnerIterator it(Q, column); it; ++it) {
      const int row = row_of[it.row()];
      if (row < 0) continue;
      if (row_of[column] >= 0) {
        entries.emplace_back(row, row_of[column], it.value());
      } else {
        split.c(row, handle_of[column]) = it.value();
      }
    }
  }
  split.Q.setFromTriplets(entries.begin(), entries.end());
  return split;
}

Status CheckInput(const geometry::SolveMesh& mesh, std::span<const int> handle_vertices) {
  if (handle_vertices.empty()) {
    return Error(StatusCode::kNoHandles, "skinning weights: there is no handle; add one");
  }
  std::vector<bool> taken(static_cast<size_t>(mesh.num_vertices()), false);
  for (size_t h = 0; h < handle_vertices.size(); ++h) {
    const int v = handle_vertices[h];
    if (v < 0 || v >= mesh.num_vertices() || taken[v]) {
      return Error(StatusCode::kInvalidArgument,
                   "skinning weights: handle %zu: vertex %d is taken or does not exist; handles "
                   "need distinct vertices below %d",
                   h, v, mesh.num_vertices());
    }
    taken[v] = true;
  }
  if (!mesh.shapes[0].allFinite()) {
    return Error(StatusCode::kDegenerate,
                 "skinning weights: the first shape has a position that is not finite; repair it");
  }
  geometry::UnionFind sets(mesh.num_vertices());
  for (const auto& [a, b, c] : mesh.triangles) {
    sets.Unite(a, b);
    sets.Unite(a, c);
  }
  for (const geometry::Bridge& bridge : mesh.bridges)
    sets.Unite(bridge.a, bridge.b);
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (sets.Find(v) != 0) {
      return Error(StatusCode::kDegenerate,
                   "skinning weights: vertex %d is not connected to vertex 0; tie loose parts "
                   "with bridges first",
                   v);
    }
  }
  return {};
}

int DivideUp(int count, int parts) {
  return (count + parts - 1) / parts;
}

// Solves the handles' problems on worker threads, some handles side by side on each. The caller's
// thread only waits and tells of the progress, so that the callback never runs anywhere else.
class HandleSolver {
 public:
  HandleSolver(const BoundedQuadratic& problem, const MatrixXd& c)
      : problem_(problem),
        c_(c),
        solutions_(MatrixXd::Zero(c.rows(), c.cols())),
        reports_(static_cast<size_t>(c.cols())),
        iterations_(static_cast<size_t>(c.cols())) {}

  Status Run(int num_threads, const ProgressCallback& progress) {
    const int handles = static_cast<int>(c_.cols());
    num_threads = std::min(num_threads, handles);
    // As few rounds as can be, and the handles spread evenly over them.
    const int rounds = DivideUp(handles, num_threads * BoundedQuadratic::kMostAtOnce);
    batch_size_ = DivideUp(handles, rounds * num_threads);
    const int num_workers = std::min(num_threads, DivideUp(handles, batch_size_));
    active_ = num_workers;
    std::vector<std::thread> workers;
    workers.reserve(static_cast<size_t>(std::max(num_workers, 0)));
    for (int i = 0; i < num_workers; ++i)
      workers.emplace_back([this] { Work(); });
    Wait(progress);
    for (std::thread& worker : workers)
      worker.join();
    if (cancelled_) return Error(StatusCode::kInvalidArgument, "cancelled");
    if (!failure_.empty()) {
      return Error(StatusCode::kInternal, "skinning weights: %s", failure_.c_str());
    }
    for (size_t h = 0; h < reports_.size(); ++h) {
      const BoundedQuadraticReport& report = reports_[h];
      if (report.converged || report.stationarity <= kUsableStationarity) continue;
      return Error(StatusCode::kDegenerate,
                   "skinning weights: handle %zu: no optimum within %d iterations (residual %.3g, "
                   "gap %.3g); check the mesh around it for degenerate triangles",
                   h, report.iterations, report.stationarity, report.gap);
    }
    return {};
  }

  const MatrixXd& solutions() const { return solutions_; }

  const std::vector<BoundedQuadraticReport>& reports() const { return reports_; }

 private:
  void Work() {
    try {
      for (int first = next_.fetch_add(batch_size_); first < c_.cols() && !cancelled_;
           first = next_.fetch_add(batch_size_)) {
        SolveHandles(first, std::min(batch_size_, static_cast<int>(c_.cols()) - first));
      }
    } catch (const std::exception& exception) {
      const std::lock_guard<std::mutex> lock(mutex_);
      failure_ = exception.what();
      cancelled_ = false;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    --active_;
    changed_.notify_all();
  }

  void SolveHandles(int first, int count) {
    MatrixXd x;
    std::vector<BoundedQuadraticReport> reports;
    problem_.Solve(
        c_.middleCols(first, count),
        [&] {
          for (int h = first; h < first + count; ++h)
            ++iterations_[h];
          changed_.notify_all();
          return !cancelled_;
        },
        &x, &reports);
    solutions_.middleCols(first, count) = x;
    std::copy(reports.begin(), reports.end(), reports_.begin() + first);
    for (int h = first; h < first + count; ++h)
      iterations_[h] = kExpectedIterations;
  }

  double Fraction() const {
    double sum = 0;
    for (const std::atomic<int>& count : iterations_) {
      sum += std::min(count.load(), kExpectedIterations);
    }
    return sum / (kExpectedIterations * static_cast<double>(iterations_.size()));
  }

  void Wait(const ProgressCallback& progress) {
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

  const BoundedQuadratic& problem_;
  const MatrixXd& c_;
  MatrixXd solutions_;
  std::vector<BoundedQuadraticReport> reports_;
  std::vector<std::atomic<int>> iterations_;
  int batch_size_ = 1;
  std::atomic<int> next_ = 0;
  std::atomic<bool> cancelled_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  int active_ = 0;
  std::string failure_;
};

// (Bounded weights need not sum to one by themselves; a row far from all handles may be zero.)
void NormaliseRows(const geometry::SolveMesh& mesh, WeightsReport* report, MatrixXd* weights) {
  for (double& weight : weights->reshaped()) {
    report->bound_violation = std::max({report->bound_violation, -weight, weight - 1});
    weight = weight < kNegligibleWeight ? 0 : std::min(weight, 1.0);
  }
  report->sum_error = (weights->rowwise().sum().array() - 1).abs().maxCoeff();
  CompleteRows(mesh, weights);
}

}  // namespace

Result<MatrixXd> BoundedBiharmonicWeights(const geometry::SolveMesh& mesh,
                                          std::span<const int> handle_vertices, int num_threads,
                                          const ProgressCallback& progress, WeightsReport* report) {
  *report = {};
  LIMBER_RETURN_IF_ERROR(CheckInput(mesh, handle_vertices));
  const auto num_handles = static_cast<Eigen::Index>(handle_vertices.size());
  if (num_handles == 1) return MatrixXd(MatrixXd::Ones(mesh.num_vertices(), 1));
  if (num_threads <= 0) {
    num_threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  }
  const Split split = SplitProblem(mesh, handle_vertices);
  if (progress && !progress("weights", 0)) return Error(StatusCode::kInvalidArgument, "cancelled");
  const BoundedQuadratic problem(split.Q);
  HandleSolver solver(problem, split.c);
  LIMBER_RETURN_IF_ERROR(solver.Run(num_threads, progress));

  MatrixXd weights = MatrixXd::Zero(mesh.num_vertices(), num_handles);
  for (size_t i = 0; i < split.free_vertices.size(); ++i) {
    weights.row(split.free_vertices[i]) = solver.solutions().row(static_cast<Eigen::Index>(i));
  }
  for (Eigen::Index h = 0; h < num_handles; ++h)
    weights(handle_vertices[h], h) = 1;
  for (const BoundedQuadraticReport& solved : solver.reports()) {
    report->handles.push_back(
        {solved.iterations, solved.converged, solved.stationarity, solved.gap});
    report->stationarity = std::max(report->stationarity, solved.stationarity);
    report->complementarity = std::max(report->complementarity, solved.gap);
  }
  NormaliseRows(mesh, report, &weights);
  return weights;
}

}  // namespace limber::bake
