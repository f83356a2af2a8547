#include "solve/held_rows.h"

#include "solve/kernels/solve_kernels.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <algorithm>

namespace limber {
namespace {

using FloatRow = Eigen::Map<const Eigen::VectorXf>;
using DoubleRow = Eigen::Map<Eigen::VectorXd>;

double Dot(const float* table, const double* numbers, size_t count) {
  const auto size = static_cast<Eigen::Index>(count);
  return FloatRow(table, size).cast<double>().dot(Eigen::Map<const Eigen::VectorXd>(numbers, size));
}

// out += factor * table row.
void AddRow(double factor, const float* table, size_t count, double* out) {
  const auto size = static_cast<Eigen::Index>(count);
  DoubleRow(out, size) += factor * FloatRow(table, size).cast<double>();
}

// An axis along which the patch is flatter than this, of its longest, says nothing of how it turns.
constexpr double kFlat = 0.05;

double WeightOf(const SkinMesh& mesh, size_t vertex, int handle) {
  return static_cast<double>(
      mesh.weights[vertex * static_cast<size_t>(mesh.num_handles) + static_cast<size_t>(handle)]);
}

// omega: zero where the handle has less than half of the say. Where that leaves too little of a
// coarse mesh, all that follow it at all.
double PatchWeight(double weight, bool coarse) {
  const double core = coarse ? weight : std::max(0.0, 2 * weight - 1);
  return core * core;
}

// p_v - p_h in the first shape.
Eigen::Vector3d FromHandle(const Rig& rig, size_t vertex, size_t centre) {
  const Vec3 p = rig.mesh().shape_positions[vertex], h = rig.mesh().shape_positions[centre];
  return Eigen::Vector3f(p.x, p.y, p.z).cast<double>() -
         Eigen::Vector3f(h.x, h.y, h.z).cast<double>();
}

Eigen::Matrix3d PatchMoments(const Rig& rig, int handle, bool coarse) {
  const size_t centre = rig.tables().handles[static_cast<size_t>(handle)].vertex;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (size_t v = 0; v < rig.mesh().num_solve_vertices; ++v) {
    const double omega = PatchWeight(WeightOf(rig.mesh(), v, handle), coarse);
    if (omega == 0) continue;
    const Eigen::Vector3d from = FromHandle(rig, v, centre);
    moments += omega * from * from.transpose();
  }
  return moments;
}

// Axes with enough of the patch along them, the longest first.
int CountAxes(const Eigen::Vector3d& moments) {
  int count = 0;
  while (count < 3 && moments[2 - count] > kFlat * kFlat * moments[2])
    ++count;
  return count;
}

}  // namespace

HeldRowTable::HeldRowTable(const Rig& rig, size_t capacity)
    : num_modes_(static_cast<size_t>(rig.tables().num_modes)),
      num_loads_(static_cast<size_t>(rig.num_groups()) * static_cast<size_t>(rig.num_shapes()) *
                 static_cast<size_t>(rig.dimension())),
      num_transforms_(static_cast<size_t>(rig.tables().num_transform_rows())),
      single_stride_(PaddedSize(static_cast<size_t>(rig.tables().num_single_modes) +
                                static_cast<size_t>(rig.dimension()))),
      single_size_(rig.num_shapes() == 1 ? 0
                                         : single_stride_ * static_cast<size_t>(rig.num_shapes())),
      translations_(capacity),
      modes_(capacity * num_modes_),
      loads_(capacity * num_loads_),
      response_(capacity * num_transforms_),
      single_(capacity * single_size_),
      coefficients_(num_transforms_) {}

size_t HeldRowTable::bytes() const {
  return BytesOf(translations_, modes_, loads_, response_, single_, coefficients_);
}

HeldRow HeldRowTable::row(size_t at) const {
  return {translations_[at], modes_.data() + at * num_modes_, loads_.data() + at * num_loads_,
          response_.data() + at * num_transforms_, single_.data() + at * single_size_};
}

void HeldRowTable::FillHandle(const Rig& rig, size_t at, int handle) {
  const RigTables& tables = rig.tables();
  const auto h = static_cast<size_t>(handle), handles = tables.handles.size();
  translations_[at] = 1;
  const float* modes = tables.handle_modes.data() + h * (1 + num_modes_) + 1;
  std::copy_n(modes, num_modes_, modes_.data() + at * num_modes_);
  const auto r1 = static_cast<size_t>(tables.num_single_modes);
  for (size_t s = 0; s * single_stride_ < single_size_; ++s) {
    const float* single = tables.single_handle_modes.data() + (s * handles + h) * (1 + r1) + 1;
    std::copy_n(single, r1, single_.data() + at * single_size_ + s * single_stride_);
  }
  FillProducts(tables, at);
}

// Adds factor times the vertex's row of M.
void HeldRowTable::AddVertex(const Rig& rig, size_t vertex, double factor) {
  const SkinMesh& mesh = rig.mesh();
  const auto shapes = static_cast<size_t>(mesh.num_shapes);
  const auto k = static_cast<size_t>(rig.dimension());
  for (size_t row = 0; row < static_cast<size_t>(mesh.num_handles) * shapes; ++row) {
    const double weight = factor * WeightOf(mesh, vertex, static_cast<int>(row / shapes));
    if (weight == 0) continue;
    const Vec3 place = mesh.shape_positions[row % shapes * mesh.num_solve_vertices + vertex];
    double* out = coefficients_.data() + row * (k + 1);
    for (size_t axis = 0; axis < k; ++axis)
      out[axis] += weight * static_cast<double>(place[static_cast<int>(axis)]);
    out[k] += weight;
  }
}

void HeldRowTable::FillPoint(const Rig& rig, size_t at, const SkinPoint& point) {
  std::fill(coefficients_.begin(), coefficients_.end(), 0.0);
  for (size_t corner = 0; corner < 3; ++corner)
    AddVertex(rig, point.vertices[corner], static_cast<double>(point.weights[corner]));
  translations_[at] = 1;
  FillFromCoefficients(rig, at);
}

PatchAxes HeldRowTable::FillAxes(const Rig& rig, size_t at, int handle) {
  const auto k = static_cast<size_t>(rig.dimension());
  const size_t centre = rig.tables().handles[static_cast<size_t>(handle)].vertex;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(PatchMoments(rig, handle, false));
  const bool coarse = CountAxes(eigen.eigenvalues()) < 2;
  if (coarse) eigen.compute(PatchMoments(rig, handle, true));
  PatchAxes patch;
  patch.count = std::min(k, static_cast<size_t>(CountAxes(eigen.eigenvalues())));
  for (size_t i = 0; i < patch.count; ++i) {
    const Eigen::Vector3d axis = eigen.eigenvectors().col(2 - static_cast<Eigen::Index>(i));
    const double scale = kAxisLength / eigen.eigenvalues()[2 - static_cast<Eigen::Index>(i)];
    std::fill(coefficients_.begin(), coefficients_.end(), 0.0);
    double sum = 0;
    for (size_t v = 0; v < rig.mesh().num_solve_vertices; ++v) {
      const double omega = PatchWeight(WeightOf(rig.mesh(), v, handle), coarse);
      if (omega == 0) continue;
      const double factor = scale * omega * axis.dot(FromHandle(rig, v, centre));
      AddVertex(rig, v, factor);
      sum += factor;
    }
    AddVertex(rig, centre, -sum);
    for (size_t c = 0; c < k; ++c)
      patch.axes[i * k + c] = kAxisLength * axis[static_cast<Eigen::Index>(c)];
    translations_[at + i] = 0;
    FillFromCoefficients(rig, at + i);
  }
  return patch;
}

// From a row of M: its modes, those of the models of one shape, and what follows.
void HeldRowTable::FillFromCoefficients(const Rig& rig, size_t at) {
  const RigTables& tables = rig.tables();
  double* modes = modes_.data() + at * num_modes_;
  std::fill_n(modes, num_modes_, 0.0);
  for (size_t row = 0; row < num_transforms_; ++row) {
    if (coefficients_[row] == 0) continue;
    AddRow(coefficients_[row], tables.mode_transforms.data() + row * (1 + num_modes_) + 1,
           num_modes_, modes);
  }
  const auto r1 = static_cast<size_t>(tables.num_single_modes);
  const auto shapes = tables.shape_names.size(), k1 = static_cast<size_t>(rig.dimension()) + 1;
  for (size_t s = 0; s * single_stride_ < single_size_; ++s) {
    double* single = single_.data() + at * single_size_ + s * single_stride_;
    std::fill_n(single, single_stride_, 0.0);
    for (size_t row = 0; row < tables.handles.size() * k1; ++row) {
      const double coefficient = coefficients_[(row / k1 * shapes + s) * k1 + row % k1];
      if (coefficient == 0) continue;
      const size_t entry = (s * tables.handles.size() * k1 + row) * (1 + r1) + 1;
      AddRow(coefficient, tables.single_mode_transforms.data() + entry, r1, single);
    }
  }
  FillProducts(tables, at);
}

void HeldRowTable::FillProducts(const RigTables& tables, size_t at) {
  const double* modes = modes_.data() + at * num_modes_;
  for (size_t row = 0; row < num_loads_; ++row) {
    loads_[at * num_loads_ + row] =
        Dot(tables.mode_edges.data() + row * num_modes_, modes, num_modes_);
  }
  for (size_t row = 0; row < num_transforms_; ++row) {
    response_[at * num_transforms_ + row] =
        Dot(tables.mode_transforms.data() + row * (1 + num_modes_) + 1, modes, num_modes_);
  }
}

}  // namespace limber
