#include "bake/example_review.h"

#include "core/vector.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cstdio>

namespace limber::bake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Mixtures have few parts, or they say little to a person.
constexpr double kSmallestPart = 0.005;
constexpr int kMostSweeps = 200;

double Diagonal(const PointMatrix& points) {
  return (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
}

bool AreWithin(double distance, const PointMatrix& a, const PointMatrix& b) {
  for (Index v = 0; v < a.rows(); ++v) {
    if ((a.row(v) - b.row(v)).squaredNorm() > distance * distance) return false;
  }
  return true;
}

// Distances from the middle, which no motion changes.
VectorXd Radii(const PointMatrix& points) {
  const Eigen::RowVector3d middle = points.colwise().mean();
  return (points.rowwise() - middle).rowwise().norm();
}

// `points` moved and turned onto `onto` as well as can be.
PointMatrix Aligned(const PointMatrix& points, const PointMatrix& onto) {
  const Eigen::Matrix4d motion = Eigen::umeyama(points.transpose(), onto.transpose(), false);
  return (points * motion.topLeftCorner<3, 3>().transpose()).rowwise() +
         motion.topRightCorner<3, 1>().transpose();
}

// The mixture b, b >= 0, sum b = 1, b_s = 0, nearest to shape s: minimises (b - e_s)^T gram
// (b - e_s) by exact exchanges between pairs. The part that gains least gives to the one that gains
// most, until nothing is worth moving.
VectorXd NearestMixture(const MatrixXd& gram, Index s) {
  const Index count = gram.cols();
  VectorXd parts = VectorXd::Constant(count, 1.0 / static_cast<double>(count - 1));
  parts(s) = 0;
  const double tolerance = 1e-14 * gram.diagonal().maxCoeff();
  VectorXd gradient = gram * parts - gram.col(s);
  for (Index exchange = 0; exchange < kMostSweeps * count; ++exchange) {
    Index to = -1, from = -1;
    for (Index i = 0; i < count; ++i) {
      if (i != s && (to < 0 || gradient(i) < gradient(to))) to = i;
      if (parts(i) > 0 && (from < 0 || gradient(i) > gradient(from))) from = i;
    }
    const double gain = gradient(from) - gradient(to);
    if (!(gain > tolerance)) break;
    const double curvature = gram(from, from) + gram(to, to) - 2 * gram(from, to);
    const bool gives_all = curvature * parts(from) <= gain;
    const double amount = gives_all ? parts(from) : gain / curvature;
    parts(to) += amount;
    parts(from) = gives_all ? 0 : parts(from) - amount;
    gradient += amount * (gram.col(to) - gram.col(from));
  }
  return parts;
}

std::string Format(const char* format, const std::string& name, const std::string& of) {
  char text[512];
  std::snprintf(text, sizeof text, format, name.c_str(), of.c_str());
  return text;
}

class Review {
 public:
  Review(std::span<const PointMatrix> shapes, std::span<const std::string> names, bool may_turn)
      : shapes_(shapes),
        names_(names),
        may_turn_(may_turn),
        tolerance_(kSameShape * Diagonal(shapes[0])) {}

  Vector<std::string> Run() {
    FindCopies();
    FindMixtures();
    return std::move(lines_);
  }

 private:
  void FindCopies() {
    for (const PointMatrix& shape : shapes_)
      radii_.push_back(Radii(shape));
    for (size_t s = 0; s < shapes_.size(); ++s) {
      const auto same =
          std::find_if(kept_.begin(), kept_.end(), [&](size_t t) { return AreSame(s, t); });
      if (same == kept_.end()) {
        kept_.push_back(s);
        continue;
      }
      const bool stands_still = AreWithin(tolerance_, shapes_[s], shapes_[*same]);
      lines_.push_back(Format(stands_still
                                  ? "shape '%s' is the same as '%s': leave it out, the bake gets "
                                    "smaller and the solve faster"
                                  : "shape '%s' is '%s' moved or turned as a whole, which the "
                                    "solver does by itself: leave it out",
                              names_[s], names_[*same]));
    }
  }

  bool AreSame(size_t s, size_t t) const {
    if (AreWithin(tolerance_, shapes_[s], shapes_[t])) return true;
    if (!may_turn_ || (radii_[s] - radii_[t]).cwiseAbs().maxCoeff() > 2 * tolerance_) return false;
    return AreWithin(tolerance_, Aligned(shapes_[s], shapes_[t]), shapes_[t]);
  }

  // Of the shapes that are no copies, as displacements from the first.
  void FindMixtures() {
    if (kept_.size() < 3) return;
    const auto count = static_cast<Index>(kept_.size());
    MatrixXd columns(3 * shapes_[0].rows(), count);
    for (Index i = 0; i < count; ++i) {
      const PointMatrix offset = shapes_[kept_[static_cast<size_t>(i)]] - shapes_[0];
      columns.col(i) = Eigen::Map<const VectorXd>(offset.data(), offset.size());
    }
    const MatrixXd gram = columns.transpose() * columns;
    for (Index s = 1; s < count; ++s) {  // whatever the rest shape is, it stays
      const VectorXd parts = NearestMixture(gram, s);
      if (IsMixture(gram, parts, s)) ReportMixture(parts, s);
    }
  }

  const PointMatrix& Kept(Index i) const { return shapes_[kept_[static_cast<size_t>(i)]]; }

  const std::string& Name(Index i) const { return names_[kept_[static_cast<size_t>(i)]]; }

  bool IsMixture(const MatrixXd& gram, const VectorXd& parts, Index s) const {
    VectorXd difference = parts;
    difference(s) -= 1;
    const double most = tolerance_ * tolerance_ * static_cast<double>(shapes_[0].rows());
    if (difference.dot(gram * difference) > most) return false;
    PointMatrix mixed = PointMatrix::Zero(shapes_[0].rows(), 3);
    for (Index i = 0; i < parts.size(); ++i) {
      if (parts(i) > 0) mixed += parts(i) * Kept(i);
    }
    return AreWithin(tolerance_, mixed, Kept(s));
  }

  void ReportMixture(const VectorXd& parts, Index s) {
    std::string mixture;
    for (Index i = 0; i < parts.size(); ++i) {
      if (parts(i) < kSmallestPart) continue;
      char part[32];
      std::snprintf(part, sizeof part, "%s%.2g ", mixture.empty() ? "" : " + ", parts(i));
      mixture += part + Name(i);
    }
    lines_.push_back(Format("shape '%s' is a mix of others (%s), which blending reaches without it",
                            Name(s), mixture));
  }

  std::span<const PointMatrix> shapes_;
  std::span<const std::string> names_;
  bool may_turn_;
  double tolerance_;
  Vector<VectorXd> radii_;
  Vector<size_t> kept_;
  Vector<std::string> lines_;
};

}  // namespace

Vector<std::string> ReviewExamples(std::span<const PointMatrix> shapes,
                                   std::span<const std::string> names, bool rotations) {
  if (shapes.size() < 2 || shapes[0].rows() == 0) return {};
  return Review(shapes, names, rotations).Run();
}

}  // namespace limber::bake
