// How much each vertex follows each handle.
#pragma once

#include "core/status.h"
#include "core/vector.h"
#include "deform/inversion_free/simplex_mesh.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace limber::deform {

enum class HandleWeightKind {
  kBoundedBiharmonic,  // Jacobson et al. 2011, over the elements: smooth at the handles
  kHarmonic,           // quick, pointed at the handles; within the bounds where no angle is obtuse
};

// [V][H], each row of numbers from 0 to 1 that sum to one; one at the handle's own vertices.
// handles: sets of vertices, none empty, none shared. Errors: kInvalidArgument, kDegenerate (a part
// of the mesh without a handle), kOutOfMemory, those of MeasureRest.
template <int D>
Result<Eigen::MatrixXd> HandleWeights(const SimplexMesh<D>& mesh,
                                      const Vector<Vector<int>>& handles, HandleWeightKind kind);

// L: the stiffness matrix of linear elements, [V][V]; masses: a (D+1)th of each element's volume to
// each corner, [V].
template <int D>
void AssembleLaplacian(const SimplexMesh<D>& mesh, const Vector<ElementRest<D>>& rest,
                       Eigen::SparseMatrix<double>* laplacian, Eigen::VectorXd* masses);

}  // namespace limber::deform
