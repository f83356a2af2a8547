#include "solve/held_rows.h"

#include "core/rotation_fit.h"
#include "solve/kernels/solve_kernels.h"

#include <Eigen/Core>

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

// How the neighbourhood of a handle is turned in a shape, from the first shape: the rotation that
// fits the vertices that follow the handle, seen from its own.
template <int K>
Eigen::Matrix<double, K, K> HandleTurn(const Rig& rig, int handle, int shape) {
  const SkinMesh& mesh = rig.mesh();
  const size_t vertices = mesh.num_solve_vertices;
  const Vec3* first = mesh.shape_positions.data();
  const Vec3* turned = first + static_cast<size_t>(shape) * vertices;
  const size_t centre = rig.tables().handles[static_cast<size_t>(handle)].vertex;
  Eigen::Matrix<double, K, K> sum = Eigen::Matrix<double, K, K>::Zero();
  for (size_t v = 0; v < vertices; ++v) {
    const double weight = static_cast<double>(
        mesh.weights[v * static_cast<size_t>(mesh.num_handles) + static_cast<size_t>(handle)]);
    if (weight == 0) continue;
    Eigen::Matrix<double, K, 1> from, to;
    for (int axis = 0; axis < K; ++axis) {
      from[axis] = static_cast<double>(first[v][axis]) - static_cast<double>(first[centre][axis]);
      to[axis] = static_cast<double>(turned[v][axis]) - static_cast<double>(turned[centre][axis]);
    }
    sum += weight * weight * from * to.transpose();
  }
  return FitRotation<K>(sum);
}

// The turns of all shapes, k x k column-major each.
void FillTurns(const Rig& rig, int handle, std::vector<double>* turns) {
  double* out = turns->data();
  for (int s = 0; s < rig.num_shapes(); ++s) {
    if (rig.dimension() == 2) {
      Eigen::Map<Eigen::Matrix2d>{out} = HandleTurn<2>(rig, handle, s);
      out += 4;
    } else {
      Eigen::Map<Eigen::Matrix3d>{out} = HandleTurn<3>(rig, handle, s);
      out += 9;
    }
  }
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
      coefficients_(num_transforms_),
      turns_(static_cast<size_t>(rig.num_shapes()) * static_cast<size_t>(rig.dimension()) *
             static_cast<size_t>(rig.dimension())) {}

size_t HeldRowTable::bytes() const {
  return BytesOf(translations_, modes_, loads_, response_, single_, coefficients_, turns_);
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

void HeldRowTable::FillPoint(const Rig& rig, size_t at, const SkinPoint& point) {
  const SkinMesh& mesh = rig.mesh();
  const auto shapes = static_cast<size_t>(mesh.num_shapes),
             k = static_cast<size_t>(rig.dimension());
  const auto handles = static_cast<size_t>(mesh.num_handles);
  std::fill(coefficients_.begin(), coefficients_.end(), 0.0);
  for (size_t corner = 0; corner < 3; ++corner) {
    const size_t vertex = point.vertices[corner];
    for (size_t row = 0; row < handles * shapes; ++row) {
      const double weight = static_cast<double>(point.weights[corner]) *
                            static_cast<double>(mesh.weights[vertex * handles + row / shapes]);
      const Vec3 place = mesh.shape_positions[row % shapes * mesh.num_solve_vertices + vertex];
      double* out = coefficients_.data() + row * (k + 1);
      for (size_t axis = 0; axis < k; ++axis)
        out[axis] += weight * static_cast<double>(place[static_cast<int>(axis)]);
      out[k] += weight;
    }
  }
  translations_[at] = 1;
  FillFromCoefficients(rig, at);
}

void HeldRowTable::FillAxes(const Rig& rig, size_t at, int handle) {
  const auto shapes = static_cast<size_t>(rig.num_shapes()),
             k = static_cast<size_t>(rig.dimension());
  FillTurns(rig, handle, &turns_);
  for (size_t axis = 0; axis < k; ++axis) {
    std::fill(coefficients_.begin(), coefficients_.end(), 0.0);
    for (size_t s = 0; s < shapes; ++s) {
      double* out = coefficients_.data() + (static_cast<size_t>(handle) * shapes + s) * (k + 1);
      for (size_t i = 0; i < k; ++i)
        out[i] = kAxisLength * turns_[(s * k + axis) * k + i];
    }
    translations_[at + axis] = 0;
    FillFromCoefficients(rig, at + axis);
  }
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
