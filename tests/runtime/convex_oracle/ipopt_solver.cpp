#include "runtime/convex_oracle/ipopt_solver.h"

#include "core/vector.h"

#include <IpIpoptApplication.hpp>
#include <IpIpoptData.hpp>
#include <IpSolveStatistics.hpp>
#include <IpTNLP.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace limber::oracle {
namespace {

using Eigen::VectorXd;
using Ipopt::Index;
using Ipopt::Number;
using Point = Eigen::Map<const VectorXd>;

// As J^T J is scaled (about one), f + delta^2 and r >= delta: below what the answers are compared
// to.
constexpr double kDelta = 1e-7;
constexpr double kUnbounded = 2e19;  // Ipopt's infinity

struct Iterate {
  VectorXd x, lower, upper, lambda;
};

// One problem with the unknowns (x, r) or x alone.
// NOLINTBEGIN(readability-function-size): Ipopt's signatures
class Program final : public Ipopt::TNLP {
 public:
  Program(const ConvexProblem& problem, IpoptSolver::Form form, Iterate* iterate)
      : problem_(problem),
        has_quotient_(problem.square_root && form == IpoptSolver::Form::kQuotient),
        has_root_(problem.square_root && form == IpoptSolver::Form::kSquareRoot),
        size_(static_cast<Index>(problem.linear.size())),
        quadratic_(problem.factor.transpose() * problem.factor),
        iterate_(*iterate) {
    for (Index column = 0; column < size_; ++column) {
      for (Index row = column; row < size_; ++row) {
        if (has_root_ || row == column || quadratic_(row, column) != 0)
          entries_.emplace_back(row, column);
      }
    }
    for (Index row = 0; row < problem.equality.rows(); ++row) {
      for (Index column = 0; column < size_; ++column) {
        if (problem.equality(row, column) != 0) constraints_.emplace_back(row, column);
      }
    }
  }

  Index num_unknowns() const { return size_ + (has_quotient_ ? 1 : 0); }

  bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian,
                    IndexStyleEnum& style) override {
    n = num_unknowns();
    m = static_cast<Index>(problem_.equality.rows());
    jacobian = static_cast<Index>(constraints_.size());
    hessian = static_cast<Index>(entries_.size()) + (has_quotient_ ? n : 0);
    style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* lower, Number* upper, Index m, Number* least,
                       Number* most) override {
    std::fill_n(upper, n, kUnbounded);
    std::fill_n(lower, n, -kUnbounded);
    std::fill(lower + problem_.first_bounded, lower + size_, 0.0);
    if (has_quotient_) lower[size_] = kDelta;
    std::copy_n(problem_.right.data(), m, least);
    std::copy_n(problem_.right.data(), m, most);
    return true;
  }

  bool get_starting_point(Index n, bool /*init_x*/, Number* x, bool init_z, Number* lower,
                          Number* upper, Index m, bool init_lambda, Number* lambda) override {
    std::copy_n(iterate_.x.data(), n, x);
    if (init_z) {
      std::copy_n(iterate_.lower.data(), n, lower);
      std::copy_n(iterate_.upper.data(), n, upper);
    }
    if (init_lambda) std::copy_n(iterate_.lambda.data(), m, lambda);
    return true;
  }

  bool eval_f(Index /*n*/, const Number* x, bool is_new, Number& value) override {
    Update(x, is_new);
    value = problem_.linear.dot(Point(x, size_));
    if (has_quotient_) {
      value += 0.5 * (f_ / x[size_] + x[size_]);
    } else {
      value += has_root_ ? std::sqrt(f_ + kDelta * kDelta) : f_;
    }
    return true;
  }

  bool eval_grad_f(Index /*n*/, const Number* x, bool is_new, Number* gradient) override {
    Update(x, is_new);
    Eigen::Map<VectorXd>(gradient, size_) = Outer(x) * slope_ + problem_.linear;
    if (has_quotient_) gradient[size_] = 0.5 * (1 - f_ / (x[size_] * x[size_]));
    return true;
  }

  bool eval_g(Index /*n*/, const Number* x, bool is_new, Index m, Number* g) override {
    Update(x, is_new);  // a point is called new only once, whoever is asked first
    Eigen::Map<VectorXd>(g, m) = problem_.equality * Point(x, size_);
    return true;
  }

  bool eval_jac_g(Index /*n*/, const Number* /*x*/, bool /*is_new*/, Index /*m*/, Index count,
                  Index* rows, Index* columns, Number* values) override {
    for (Index i = 0; i < count; ++i) {
      const auto [row, column] = constraints_[static_cast<size_t>(i)];
      if (values != nullptr) {
        values[i] = problem_.equality(row, column);
      } else {
        rows[i] = row;
        columns[i] = column;
      }
    }
    return true;
  }

  // The constraints are linear: the objective's alone, lower triangle.
  bool eval_h(Index n, const Number* x, bool is_new, Number scale, Index /*m*/,
              const Number* /*lambda*/, bool /*new_lambda*/, Index /*count*/, Index* rows,
              Index* columns, Number* values) override {
    const size_t inner = entries_.size();
    if (values == nullptr) {
      for (size_t i = 0; i < inner; ++i)
        std::tie(rows[i], columns[i]) = entries_[i];
      for (Index i = 0; has_quotient_ && i < n; ++i) {
        rows[inner + static_cast<size_t>(i)] = size_;
        columns[inner + static_cast<size_t>(i)] = i;
      }
      return true;
    }
    Update(x, is_new);
    const double outer = Outer(x) * scale;
    const double bend = has_root_ ? 0.25 * scale / std::pow(f_ + kDelta * kDelta, 1.5) : 0;
    for (size_t i = 0; i < inner; ++i) {
      const auto [row, column] = entries_[i];
      values[i] = outer * quadratic_(row, column) - bend * slope_[row] * slope_[column];
    }
    if (has_quotient_) {
      const double root = x[size_];
      Eigen::Map<VectorXd>(values + inner, size_) = -0.5 * scale / (root * root) * slope_;
      values[inner + static_cast<size_t>(size_)] = scale * f_ / (root * root * root);
    }
    return true;
  }

  void finalize_solution(Ipopt::SolverReturn /*status*/, Index n, const Number* x,
                         const Number* lower, const Number* upper, Index m, const Number* /*g*/,
                         const Number* lambda, Number /*objective*/, const Ipopt::IpoptData* data,
                         Ipopt::IpoptCalculatedQuantities* /*quantities*/) override {
    iterate_ = {Point(x, n), Point(lower, n), Point(upper, n), Point(lambda, m)};
    iterations_ = data != nullptr ? data->iter_count() : 0;
  }

  int iterations() const { return iterations_; }

 private:
  // What f's gradient is multiplied by in the objective's.
  double Outer(const Number* x) const {
    if (has_quotient_) return 0.5 / x[size_];
    return has_root_ ? 0.5 / std::sqrt(f_ + kDelta * kDelta) : 1;
  }

  void Update(const Number* x, bool is_new) {
    if (!is_new && slope_.size() == size_) return;
    const VectorXd residual = problem_.factor * Point(x, size_) - problem_.goal;
    f_ = 0.5 * residual.squaredNorm();
    slope_ = problem_.factor.transpose() * residual;
  }

  const ConvexProblem& problem_;
  bool has_quotient_, has_root_;
  Index size_;
  Eigen::MatrixXd quadratic_;  // J^T J
  Vector<std::pair<Index, Index>> entries_, constraints_;
  Iterate& iterate_;
  double f_ = 0;
  VectorXd slope_;  // of f
  int iterations_ = 0;
};

// NOLINTEND(readability-function-size)

void SetOptions(bool warm, Ipopt::IpoptApplication* application) {
  Ipopt::OptionsList& options = *application->Options();
  options.SetNumericValue("bound_relax_factor", 0);
  options.SetIntegerValue("max_iter", 500);
  options.SetStringValue("jac_c_constant", "yes");
  options.SetStringValue("warm_start_init_point", warm ? "yes" : "no");
  options.SetNumericValue("mu_init", warm ? 1e-5 : 0.1);
  for (const char* push :
       {"warm_start_bound_push", "warm_start_bound_frac", "warm_start_mult_bound_push"}) {
    options.SetNumericValue(push, 1e-5);
  }
}

}  // namespace

struct IpoptSolver::State {
  Form form;
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application;
  Iterate iterate;
};

bool IpoptSolver::IsAvailable() {
  return true;
}

IpoptSolver::IpoptSolver(Form form, double tolerance)
    : state_(new State{form, new Ipopt::IpoptApplication, {}}) {
  state_->application->Options()->SetIntegerValue("print_level", 0);
  state_->application->Options()->SetStringValue("sb", "yes");
  state_->application->Options()->SetNumericValue("tol", tolerance);
  state_->application->Initialize("");  // no file of options
}

IpoptSolver::~IpoptSolver() = default;

IpoptAnswer IpoptSolver::Solve(const ConvexProblem& problem, const VectorXd& start, bool warm) {
  Iterate& iterate = state_->iterate;
  const Ipopt::SmartPtr<Program> program = new Program(problem, state_->form, &iterate);
  const Index size = program->num_unknowns();
  warm = warm && iterate.x.size() == size && iterate.lambda.size() == problem.equality.rows();
  iterate.x.conservativeResize(size);
  iterate.x.head(start.size()) = start;
  if (size > start.size()) iterate.x[size - 1] = std::max(std::sqrt(problem.F(start)), 2 * kDelta);
  SetOptions(warm, Ipopt::GetRawPtr(state_->application));
  const auto before = std::chrono::steady_clock::now();
  const Ipopt::ApplicationReturnStatus status =
      state_->application->OptimizeTNLP(Ipopt::GetRawPtr(program));
  IpoptAnswer answer;
  answer.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
  answer.converged =
      status == Ipopt::Solve_Succeeded || status == Ipopt::Solved_To_Acceptable_Level;
  answer.x = iterate.x.head(start.size());
  answer.objective = problem.Objective(answer.x);
  answer.iterations = program->iterations();
  return answer;
}

}  // namespace limber::oracle
