// The convex step on random problems, most of them degenerate in a way that characters are: each
// answer carries a certificate of optimality, and a general optimiser finds nothing better.
#include "runtime/convex_oracle/ipopt_solver.h"
#include "runtime/solve/dense_form.h"
#include "solve/blend_weight_step.h"

#include <gtest/gtest.h>

#include <random>

namespace limber::oracle {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr unsigned kSeeds = 40;  // problems of each kind
constexpr double kDeltaSquared = 1e-14;
// The kink is rounded off by delta: what that may cost, where the objective itself is (nearly) 0.
constexpr double kKinkCost = 2e-7;

enum class Kind {
  kGeneric,
  kFewRows,         // more weights than equations
  kRepeatedShapes,  // two shapes the same
  kEqualInGroup,    // all shapes the same in a group
  kCoplanarShapes,  // in each group one shape is the mean of two others, nearness included
  kZeroNearness,
  kMixMatches,              // f = 0 at a mix: the square root is not smooth there
  kMixMatchesZeroNearness,  // and nothing else decides
  kShapeMatches,            // f = 0 where one shape alone has all the weight
  kShapeMatchesNearest,     // and D is zero there
  kManyMatches,             // f = 0 on a whole face
};

constexpr Kind kKinds[] = {Kind::kGeneric,
                           Kind::kFewRows,
                           Kind::kRepeatedShapes,
                           Kind::kEqualInGroup,
                           Kind::kCoplanarShapes,
                           Kind::kZeroNearness,
                           Kind::kMixMatches,
                           Kind::kShapeMatches,
                           Kind::kMixMatchesZeroNearness,
                           Kind::kManyMatches,
                           Kind::kShapeMatchesNearest};

struct RandomCase {
  int groups = 0, shapes = 0;
  ConvexProblem problem;
};

MatrixXd Random(Index rows, Index columns, std::mt19937* numbers) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  return MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(*numbers); });
}

void Degenerate(Kind kind, std::mt19937* numbers, RandomCase* random) {
  ConvexProblem& p = random->problem;
  const Index shapes = random->shapes, size = p.linear.size();
  VectorXd mix = VectorXd::Zero(size);
  for (Index first = 0; first < size; first += shapes) {
    const Index middle = first + shapes / 2;
    mix[first] = 0.3;
    mix[middle] = 0.7;
    if (kind == Kind::kRepeatedShapes || kind == Kind::kManyMatches) {
      p.factor.col(middle) = p.factor.col(first);
      p.linear[middle] = p.linear[first];
    }
    if (kind == Kind::kEqualInGroup && first % (2 * shapes) == 0) {
      const VectorXd column = p.factor.col(first);
      p.factor.middleCols(first, shapes).colwise() = column;
    }
    if (kind == Kind::kCoplanarShapes) {
      const Index last = first + shapes - 1;
      p.factor.col(middle) = 0.5 * (p.factor.col(first) + p.factor.col(last));
      p.linear[middle] = 0.5 * (p.linear[first] + p.linear[last]);
    }
    if (kind == Kind::kShapeMatches || kind == Kind::kShapeMatchesNearest) {
      mix.segment(first, shapes).setZero();
      const Index match = first + static_cast<Index>((*numbers)() % random->shapes);
      mix[match] = 1;
      if (kind == Kind::kShapeMatchesNearest) p.linear[match] = 0;
    }
  }
  if (kind >= Kind::kMixMatches) p.goal = p.factor * mix;
  if (kind == Kind::kZeroNearness || kind == Kind::kMixMatchesZeroNearness) p.linear.setZero();
}

RandomCase Make(Kind kind, unsigned seed, bool square_root) {
  std::mt19937 numbers(seed * 64 + static_cast<unsigned>(kind));
  RandomCase random{1 + static_cast<int>(seed % 7), 2 + static_cast<int>(seed / 7 % 5), {}};
  ConvexProblem& p = random.problem;
  const Index size = Index{random.groups} * random.shapes;
  const Index rows = kind == Kind::kFewRows ? 1 + size / 3 : size + 3;
  p.factor = Random(rows, size, &numbers);
  p.goal = Random(rows, 1, &numbers);
  p.linear = 0.3 * Random(size, 1, &numbers).cwiseAbs();
  p.square_root = square_root;
  Degenerate(kind, &numbers, &random);
  p.equality.resize(0, size);
  AddSimplices(random.shapes, &p);
  return random;
}

// The runtime's step, called until B rests as frames do (the proximal term vanishes there). As in
// a character a part of f is given as rows with a goal, the other, which has none, as a quadratic
// form: an orthogonal turn of the rows moves all of the goal into the first one.
VectorXd SolveFast(const RandomCase& random, BlendReport* report) {
  const ConvexProblem& p = random.problem;
  const Index rows = p.factor.rows(), size = p.linear.size();
  MatrixXd factor = p.factor;
  VectorXd goal = p.goal;
  VectorXd axis = goal;
  axis[0] += goal[0] < 0 ? -goal.norm() : goal.norm();
  const double squared = axis.squaredNorm();
  if (squared > 0) {
    factor -= (2 / squared * axis) * (axis.transpose() * factor);
    goal -= 2 / squared * axis.dot(goal) * axis;
  }
  const MatrixXd rest = factor.bottomRows(rows - 1);
  test::DenseForm form(rest.transpose() * rest, factor.topRows(1));
  BlendProblem problem;
  problem.form = &form;
  problem.num_rows = 1;
  problem.goal = goal.data();
  problem.nearness = p.linear.data();
  problem.square_root = p.square_root;
  problem.delta_squared = kDeltaSquared;
  problem.proximal = 1e-10;
  BlendWeightStep step(ChooseSolveKernels<3>(), random.groups, random.shapes, 1);
  VectorXd blend = VectorXd::Constant(size, 1.0 / random.shapes);
  for (int call = 0; call < 5; ++call)
    *report = step.Solve(problem, blend.data());
  return blend;
}

double Allowed(double objective) {
  return 1e-6 * std::abs(objective) + kKinkCost;
}

class RandomProblems : public testing::TestWithParam<bool> {};

TEST_P(RandomProblems, Answers_CarryACertificateOfOptimality) {
  for (const Kind kind : kKinds) {
    for (unsigned seed = 0; seed < kSeeds; ++seed) {
      SCOPED_TRACE("kind " + std::to_string(static_cast<int>(kind)) + " seed " +
                   std::to_string(seed));
      const RandomCase random = Make(kind, seed, GetParam());
      BlendReport report;
      const VectorXd blend = SolveFast(random, &report);
      EXPECT_TRUE(report.converged);
      const Certificate certificate = Certify(random.problem, random.shapes, kDeltaSquared, blend);
      EXPECT_LT(certificate.infeasibility, 1e-12);
      EXPECT_LE(certificate.objective - certificate.lower_bound, Allowed(certificate.objective));
    }
  }
}

// The certificate can fail: a hundredth of a weight moved to another shape must show.
TEST_P(RandomProblems, PerturbedAnswer_HasNoCertificate) {
  for (const Kind kind : {Kind::kGeneric, Kind::kMixMatches, Kind::kShapeMatchesNearest}) {
    for (unsigned seed = 0; seed < kSeeds; ++seed) {
      const RandomCase random = Make(kind, seed, GetParam());
      BlendReport report;
      VectorXd blend = SolveFast(random, &report);
      Index most = 0;
      blend.head(random.shapes).maxCoeff(&most);
      blend[most] -= 0.01;
      blend[(most + 1) % random.shapes] += 0.01;
      const Certificate certificate = Certify(random.problem, random.shapes, kDeltaSquared, blend);
      EXPECT_LT(certificate.infeasibility, 1e-12);
      EXPECT_GT(certificate.objective - certificate.lower_bound, 2 * Allowed(certificate.objective))
          << "kind " << static_cast<int>(kind) << " seed " << seed;
    }
  }
}

TEST_P(RandomProblems, Ipopt_FindsNothingBetter) {
  if (!IpoptSolver::IsAvailable()) GTEST_SKIP() << "built without Ipopt (coinor-libipopt-dev)";
  IpoptSolver ipopt(IpoptSolver::Form::kQuotient, 1e-8);
  int converged = 0, problems = 0;
  for (const Kind kind : kKinds) {
    for (unsigned seed = 0; seed < kSeeds; seed += 4) {
      const RandomCase random = Make(kind, seed, GetParam());
      BlendReport report;
      const VectorXd blend = SolveFast(random, &report);
      const VectorXd start = VectorXd::Constant(blend.size(), 1.0 / random.shapes);
      const IpoptAnswer answer = ipopt.Solve(random.problem, start, false);
      ++problems;
      converged += answer.converged ? 1 : 0;
      ASSERT_LT((random.problem.equality * answer.x - random.problem.right).norm(), 1e-9);
      EXPECT_LE(random.problem.Objective(blend), answer.objective + Allowed(answer.objective))
          << "kind " << static_cast<int>(kind) << " seed " << seed;
      // And it finds the same optimum: were it far worse, the comparison would mean nothing.
      EXPECT_LE(answer.objective, random.problem.Objective(blend) + 1e-5)
          << "kind " << static_cast<int>(kind) << " seed " << seed;
    }
  }
  EXPECT_GE(converged, problems * 9 / 10);
}

INSTANTIATE_TEST_SUITE_P(SquareRoot, RandomProblems, testing::Bool(), [](const auto& test) {
  return test.param ? "WithSquareRoot" : "WithoutSquareRoot";
});

}  // namespace
}  // namespace limber::oracle
