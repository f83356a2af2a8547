#include "deform/inversion_free/handle_weights.h"

#include "made_elements.h"

#include <gtest/gtest.h>

namespace limber::deform {
namespace {

constexpr HandleWeightKind kKinds[] = {HandleWeightKind::kBoundedBiharmonic,
                                       HandleWeightKind::kHarmonic};

Vector<Vector<int>> EndsOf(const TetMesh& bar) {
  const double end = bar.rest.col(2).maxCoeff();
  return {test::VerticesWhere(bar, [](const auto& p) { return p.z() < 1e-9; }),
          test::VerticesWhere(bar, [&](const auto& p) { return p.z() > end - 1e-9; })};
}

TEST(HandleWeights, EndsOfABar_AreSharedOutAlongIt) {
  const TetMesh bar = test::MakeBar(3, 3, 9);
  for (const HandleWeightKind kind : kKinds) {
    const auto weights = HandleWeights(bar, EndsOf(bar), kind);
    ASSERT_TRUE(weights.ok()) << weights.status().message();
    EXPECT_GE(weights->minCoeff(), 0);
    EXPECT_LT((weights->rowwise().sum().array() - 1).abs().maxCoeff(), 1e-12);
    for (int v = 0; v < bar.num_vertices(); ++v) {
      const double along = bar.rest(v, 2) / 3;  // 0 to 1
      if (kind == HandleWeightKind::kHarmonic) {
        EXPECT_NEAR((*weights)(v, 1), along, 1e-9) << "linear along the bar";
      }
      if (along < 1e-9) {
        EXPECT_EQ((*weights)(v, 0), 1);
      }
      if (std::abs(along - 0.5) > 0.4) continue;
      EXPECT_EQ((*weights)(v, 1) > 0.5, along > 0.5) << along;
    }
  }
}

TEST(HandleWeights, Bounded_IsTheCubicOfABeam) {
  // Two ends of a bar with free sides: no bound is met, and the least bending between them with
  // free ends is linear within; the smoothness at a clamped end is not asked for. What can be told
  // without that: it mirrors, and its energy is below that of the harmonic weights.
  const TetMesh bar = test::MakeBar(2, 2, 8);
  const auto weights = HandleWeights(bar, EndsOf(bar), HandleWeightKind::kBoundedBiharmonic);
  ASSERT_TRUE(weights.ok());
  for (int v = 0; v < bar.num_vertices(); ++v) {
    for (int other = 0; other < bar.num_vertices(); ++other) {
      const Eigen::RowVector3d mirrored(bar.rest(v, 0), bar.rest(v, 1), 4 - bar.rest(v, 2));
      if ((bar.rest.row(other) - mirrored).norm() > 1e-9) continue;
      EXPECT_NEAR((*weights)(v, 0), (*weights)(other, 1), 1e-5);
    }
  }
}

TEST(HandleWeights, WishesThatMakeNoSense_AreRefused) {
  const TetMesh bar = test::MakeBar(2, 2, 2);
  const auto code = [&](const Vector<Vector<int>>& handles) {
    return HandleWeights(bar, handles, HandleWeightKind::kHarmonic).status().code();
  };
  EXPECT_EQ(code({{0}, {}}), StatusCode::kInvalidArgument);
  EXPECT_EQ(code({{0}, {1, 0}}), StatusCode::kInvalidArgument);
  EXPECT_EQ(code({{0}, {27}}), StatusCode::kInvalidArgument);
  EXPECT_EQ(code({{0}, {-1}}), StatusCode::kInvalidArgument);
  EXPECT_EQ(code({{0}, {1}}), StatusCode::kOk);
}

TEST(HandleWeights, APartWithoutAHandle_IsRefused) {
  TetMesh two = test::MakeBar(1, 1, 1);
  const int count = two.num_vertices();
  TetMesh::Positions rest(2 * count, 3);
  rest << two.rest, two.rest.array() + 10;
  two.rest = rest;
  for (size_t i = 0, end = two.elements.size(); i < end; ++i) {
    auto element = two.elements[i];
    for (int& corner : element)
      corner += count;
    two.elements.push_back(element);
  }
  EXPECT_EQ(HandleWeights(two, {{0}, {1}}, HandleWeightKind::kHarmonic).status().code(),
            StatusCode::kDegenerate);
}

}  // namespace
}  // namespace limber::deform
