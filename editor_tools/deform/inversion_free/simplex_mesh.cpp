#include "deform/inversion_free/simplex_mesh.h"

#include <Eigen/LU>

#include <cmath>
#include <utility>

namespace limber::deform {
namespace {

// The edges from the first corner, as columns.
template <int D>
Eigen::Matrix<double, D, D> Edges(const typename SimplexMesh<D>::Positions& positions,
                                  const typename SimplexMesh<D>::Element& element) {
  const Eigen::Matrix<double, D, D + 1> corners = Corners<D>(positions, element);
  return corners.template rightCols<D>().colwise() - corners.col(0);
}

template <int D>
Status CheckCorners(const SimplexMesh<D>& mesh) {
  if (mesh.elements.empty()) return Error(StatusCode::kDegenerate, "the mesh has no element");
  if (!mesh.rest.allFinite())
    return Error(StatusCode::kMalformed, "a position of the mesh is not finite");
  for (int i = 0; i < mesh.num_elements(); ++i) {
    for (const int corner : mesh.elements[static_cast<size_t>(i)]) {
      if (corner >= 0 && corner < mesh.num_vertices()) continue;
      return Error(StatusCode::kMalformed, "element %d: corner %d; expected below %d", i, corner,
                   mesh.num_vertices());
    }
  }
  return {};
}

}  // namespace

template <int D>
double SignedSize(const typename SimplexMesh<D>::Positions& positions,
                  const typename SimplexMesh<D>::Element& element) {
  return Edges<D>(positions, element).determinant();
}

template <int D>
int Orient(SimplexMesh<D>* mesh) {
  int turned = 0;
  for (auto& element : mesh->elements) {
    if (SignedSize<D>(mesh->rest, element) >= 0) continue;
    std::swap(element[0], element[1]);
    ++turned;
  }
  return turned;
}

template <int D>
Result<Vector<ElementRest<D>>> MeasureRest(const SimplexMesh<D>& mesh) {
  const Status checked = CheckCorners(mesh);
  if (!checked.ok()) return checked;
  const double factorial = D == 2 ? 2 : 6;
  Vector<ElementRest<D>> rest(mesh.elements.size());
  for (size_t i = 0; i < rest.size(); ++i) {
    const Eigen::Matrix<double, D, D> edges = Edges<D>(mesh.rest, mesh.elements[i]);
    const double size = edges.determinant(), length = edges.colwise().norm().maxCoeff();
    // Flatter than this, its gradients would be nothing but rounding.
    if (!(size > 1e-12 * std::pow(length, D))) {
      return Error(StatusCode::kDegenerate, "element %zu: %s at rest (volume %.3g)", i,
                   size < 0 ? "inside out" : "flat", size / factorial);
    }
    const Eigen::Matrix<double, D, D> inverse = edges.inverse();
    rest[i].volume = size / factorial;
    rest[i].gradients.template rightCols<D>() = inverse.transpose();
    rest[i].gradients.col(0) = -inverse.colwise().sum().transpose();
  }
  return rest;
}

template int Orient(SimplexMesh<2>*);
template int Orient(SimplexMesh<3>*);
template double SignedSize<2>(const TriangleMesh::Positions&, const TriangleMesh::Element&);
template double SignedSize<3>(const TetMesh::Positions&, const TetMesh::Element&);
template Result<Vector<ElementRest<2>>> MeasureRest(const SimplexMesh<2>&);
template Result<Vector<ElementRest<3>>> MeasureRest(const SimplexMesh<3>&);

}  // namespace limber::deform
