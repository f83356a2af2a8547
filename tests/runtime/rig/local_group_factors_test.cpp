// Energies of single groups, from the transforms of few handles to the modes of all.
#include "rig/local_group_factors.h"

#include "core/vector.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace limber {
namespace {

constexpr int kHandles = 4, kShapes = 2, kGroups = 3, kModes = 7;

using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Vector<float> RandomNumbers(int64_t count, std::mt19937* random) {
  std::uniform_real_distribution<float> uniform(-1, 1);
  Vector<float> numbers(static_cast<size_t>(count));
  for (float& x : numbers)
    x = uniform(*random);
  return numbers;
}

struct Subject {
  RigTables tables;
  LocalGroupFactors local;
};

// Groups that one handle moves, that none moves, that all do.
Subject MakeSubject(int dimension) {
  std::mt19937 random(5);
  Subject subject;
  RigTables& t = subject.tables;
  t.dimension = dimension;
  t.num_groups = kGroups;
  t.num_single_modes = kModes;
  t.handles.resize(kHandles);
  t.shape_names.resize(kShapes);
  t.single_mode_transforms = RandomNumbers(int64_t{t.num_transform_rows()} * (1 + kModes), &random);
  subject.local.group_handles = {0, 0, 1, 0, 0, 0, 0, 0, 1, 1, 1, 1};
  const Result<int64_t> count = NumLocalFactors(t, subject.local.group_handles);
  EXPECT_TRUE(count.ok()) << count.status().message();
  subject.local.factors = RandomNumbers(*count, &random);
  return subject;
}

// U of one packed triangle.
Eigen::MatrixXd Upper(const float* packed, Eigen::Index size) {
  Eigen::MatrixXd upper = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = i; j < size; ++j)
      upper(i, j) = static_cast<double>(*packed++);
  }
  return upper;
}

class LocalGroupFactorsTest : public testing::TestWithParam<int> {};

// |U_sg [T; -R^T]|^2 with T = Phi_1 z by its definition, against the table in modes.
TEST_P(LocalGroupFactorsTest, Expanded_GiveTheSameEnergies) {
  Subject subject = MakeSubject(GetParam());
  RigTables& t = subject.tables;
  ASSERT_TRUE(ExpandLocalGroupFactors(subject.local, &t).ok());
  const Eigen::Index k = t.dimension, rows = kHandles * (k + 1), m = kModes + k;
  ASSERT_EQ(t.single_group_factors.size(),
            static_cast<size_t>(kShapes * kGroups * m * (m + 1) / 2));
  ASSERT_EQ(t.single_edges.size(), static_cast<size_t>(kShapes * kGroups * k * kModes));
  const float* local = subject.local.factors.data();
  for (int block = 0; block < kShapes * kGroups; ++block) {
    const Eigen::Map<const RowMajor> phi(
        t.single_mode_transforms.data() + block / kGroups * rows * (1 + kModes), rows, 1 + kModes);
    const Eigen::MatrixXd z = Eigen::MatrixXd::Random(kModes, k),
                          turn = Eigen::MatrixXd::Random(k, k);
    const Eigen::MatrixXd all = phi.rightCols(kModes).cast<double>() * z;
    Eigen::MatrixXd stacked(0, k);
    for (int h = 0; h < kHandles; ++h) {
      if (subject.local.group_handles[static_cast<size_t>(block % kGroups * kHandles + h)] == 0)
        continue;
      stacked.conservativeResize(stacked.rows() + k + 1, k);
      stacked.bottomRows(k + 1) = all.middleRows(h * (k + 1), k + 1);
    }
    stacked.conservativeResize(stacked.rows() + k, k);
    stacked.bottomRows(k) = -turn;
    const Eigen::MatrixXd upper = Upper(local, stacked.rows());
    local += stacked.rows() * (stacked.rows() + 1) / 2;

    Eigen::MatrixXd modes(m, k);
    modes << z, -turn;
    const Eigen::MatrixXd expanded =
        Upper(t.single_group_factors.data() + block * (m * (m + 1) / 2), m);
    const double energy = (upper * stacked).squaredNorm();
    EXPECT_NEAR((expanded * modes).squaredNorm(), energy, 1e-5 * energy);
    // The mixed part of U^T U: what the modes' pull on the edges is.
    const Eigen::Map<const RowMajor> edges(t.single_edges.data() + block * k * kModes, k, kModes);
    const Eigen::MatrixXd gram = expanded.transpose() * expanded;
    EXPECT_LT((gram.bottomLeftCorner(k, kModes) - edges.cast<double>()).norm(),
              1e-5 * (1 + gram.norm()));
  }
  EXPECT_EQ(local, subject.local.factors.data() + subject.local.factors.size());
}

INSTANTIATE_TEST_SUITE_P(Dimensions, LocalGroupFactorsTest, testing::Values(2, 3));

TEST(LocalGroupFactors, WrongParts_AreMalformed) {
  const auto code_with = [](const std::function<void(Subject*)>& damage) {
    Subject subject = MakeSubject(3);
    damage(&subject);
    return ExpandLocalGroupFactors(subject.local, &subject.tables).code();
  };
  EXPECT_EQ(code_with([](Subject*) {}), StatusCode::kOk);
  EXPECT_EQ(code_with([](Subject* s) { s->local.group_handles.pop_back(); }),
            StatusCode::kMalformed);
  EXPECT_EQ(code_with([](Subject* s) { s->local.group_handles[0] = 0.5f; }),
            StatusCode::kMalformed);
  EXPECT_EQ(code_with([](Subject* s) { s->local.group_handles[0] = 1; }), StatusCode::kMalformed)
      << "more handles than factors";
  EXPECT_EQ(code_with([](Subject* s) { s->local.factors.pop_back(); }), StatusCode::kMalformed);
  EXPECT_EQ(code_with([](Subject* s) { s->tables.single_mode_transforms.clear(); }),
            StatusCode::kMalformed);
}

}  // namespace
}  // namespace limber
