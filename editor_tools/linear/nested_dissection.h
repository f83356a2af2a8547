// An elimination order for the matrices of surfaces: parts first, what separates them last.
#pragma once

#include "core/vector.h"

#include <Eigen/SparseCore>

namespace limber::linear {

// [n]: where each column of a symmetric pattern, given whole, comes in the order. Halves are the
// two sides of the smallest level near the middle of a breadth-first search from one end of a part
// to the other (George and Liu's automatic nested dissection); small parts are left to minimum
// degree. Deterministic.
Vector<int> NestedDissection(const Eigen::SparseMatrix<double>& Q);

}  // namespace limber::linear
