// Example shapes that say nothing new are named; those that do are not.
#include "bake/example_review.h"

#include "core/vector.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace limber::bake {
namespace {

PointMatrix RandomShape(uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  PointMatrix shape(60, 3);
  for (Eigen::Index i = 0; i < shape.size(); ++i)
    shape.data()[i] = number(random);
  return shape;
}

PointMatrix Turned(const PointMatrix& shape) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  return (shape * turn.transpose()).rowwise() + Eigen::RowVector3d(5, -2, 1);
}

Vector<std::string> Review(const Vector<PointMatrix>& shapes, bool rotations = true) {
  Vector<std::string> names;
  for (size_t s = 0; s < shapes.size(); ++s)
    names.push_back("s" + std::to_string(s));
  return ReviewExamples(shapes, names, rotations);
}

TEST(ReviewExamples, ShapesThatDiffer_AreLeftInPeace) {
  EXPECT_TRUE(Review({RandomShape(1), RandomShape(2), RandomShape(3), RandomShape(4)}).empty());
  EXPECT_TRUE(Review({RandomShape(1)}).empty());
  EXPECT_TRUE(Review({}).empty());
}

TEST(ReviewExamples, ACopy_IsNamedWithItsOriginal) {
  PointMatrix copy = RandomShape(2);
  copy.array() += 1e-5;  // far below a ten-thousandth of the size
  const auto lines = Review({RandomShape(1), RandomShape(2), RandomShape(3), copy});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("'s3' is the same as 's1'"), std::string::npos) << lines[0];
}

TEST(ReviewExamples, SmallButRealChanges_AreNoCopy) {
  PointMatrix other = RandomShape(2);
  other.row(7) += Eigen::RowVector3d(0.01, 0, 0);  // of a size of three and a half
  EXPECT_TRUE(Review({RandomShape(1), RandomShape(2), other}).empty());
}

// A mirrored shape is another one, whatever its distances say.
TEST(ReviewExamples, ATurnedCopy_IsUselessOnlyWhereTheSolverTurns) {
  const Vector<PointMatrix> shapes = {RandomShape(1), RandomShape(2), Turned(RandomShape(2))};
  const auto lines = Review(shapes);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("'s2' is 's1' moved or turned"), std::string::npos) << lines[0];
  EXPECT_TRUE(Review(shapes, false).empty());
  PointMatrix mirrored = RandomShape(2);
  mirrored.col(0) *= -1;
  EXPECT_TRUE(Review({RandomShape(1), RandomShape(2), mirrored}).empty());
}

TEST(ReviewExamples, AMixture_IsNamedWithItsParts) {
  const PointMatrix mix = 0.25 * RandomShape(1) + 0.75 * RandomShape(3);
  const auto lines = Review({RandomShape(1), RandomShape(2), RandomShape(3), mix, RandomShape(5)});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("'s3' is a mix of others (0.25 s0 + 0.75 s2)"), std::string::npos)
      << lines[0];
}

// Outside the others' hull, though in their plane: no mixture reaches it.
TEST(ReviewExamples, AnExaggeration_IsNoMixture) {
  const PointMatrix beyond = 1.5 * RandomShape(2) - 0.5 * RandomShape(1);
  EXPECT_EQ(Review({RandomShape(1), RandomShape(2), RandomShape(3)}).size(), 0u);
  const auto lines = Review({RandomShape(1), RandomShape(2), beyond, RandomShape(3)});
  ASSERT_EQ(lines.size(), 1u);  // s1 lies between the rest shape and the exaggeration
  EXPECT_NE(lines[0].find("'s1' is a mix of others"), std::string::npos) << lines[0];
}

}  // namespace
}  // namespace limber::bake
