#include "bake/group_repair.h"

#include "core/vector.h"
#include "geometry/union_find.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace limber::bake {
namespace {

constexpr int kNone = -1;

template <class Visit>
void ForEachEdge(const geometry::SolveMesh& mesh, const Visit& visit) {
  for (const auto& [a, b, c] : mesh.triangles) {
    visit(a, b);
    visit(b, c);
    visit(c, a);
  }
  for (const geometry::Bridge& bridge : mesh.bridges)
    visit(bridge.a, bridge.b);
}

struct Piece {
  int group = 0;  // where it belongs, or belonged
  int size = 0;
  bool stays = false;
  Eigen::RowVectorXd sum;  // of its vertices' weights
};

class Repair {
 public:
  Repair(const geometry::SolveMesh& mesh, const Eigen::MatrixXd& weights, int num_groups,
         Vector<int>* vertex_group)
      : mesh_(mesh),
        weights_(weights),
        group_(*vertex_group),
        group_sums_(Eigen::MatrixXd::Zero(num_groups, weights.cols())),
        group_sizes_(static_cast<size_t>(num_groups), 0) {}

  int Run() {
    FindPieces();
    KeepTheLargest();
    int moved = 0;
    while (MoveARound(&moved)) {
    }
    for (size_t v = 0; v < group_.size(); ++v)
      group_[v] = pieces_[static_cast<size_t>(piece_of_[v])].group;
    return moved;
  }

 private:
  Piece& PieceOf(int vertex) {
    return pieces_[static_cast<size_t>(piece_of_[static_cast<size_t>(vertex)])];
  }

  void FindPieces() {
    geometry::UnionFind sets(mesh_.num_vertices());
    ForEachEdge(mesh_, [&](int a, int b) {
      if (group_[static_cast<size_t>(a)] == group_[static_cast<size_t>(b)]) sets.Unite(a, b);
    });
    piece_of_.assign(group_.size(), kNone);
    for (int v = 0; v < mesh_.num_vertices(); ++v) {
      const auto root = static_cast<size_t>(sets.Find(v));  // the first vertex of the piece
      if (piece_of_[root] == kNone) {
        piece_of_[root] = static_cast<int>(pieces_.size());
        pieces_.push_back({group_[root], 0, false, Eigen::RowVectorXd::Zero(weights_.cols())});
      }
      piece_of_[static_cast<size_t>(v)] = piece_of_[root];
      PieceOf(v).size += 1;
      PieceOf(v).sum += weights_.row(v);
    }
  }

  void KeepTheLargest() {
    Vector<int> largest(group_sizes_.size(), kNone);
    for (size_t p = 0; p < pieces_.size(); ++p) {
      int& best = largest[static_cast<size_t>(pieces_[p].group)];
      if (best == kNone || pieces_[p].size > pieces_[static_cast<size_t>(best)].size)
        best = static_cast<int>(p);
    }
    for (const int p : largest) {
      if (p == kNone) continue;
      Piece& piece = pieces_[static_cast<size_t>(p)];
      piece.stays = true;
      AddToGroup(piece);
    }
  }

  void AddToGroup(const Piece& piece) {
    group_sums_.row(piece.group) += piece.sum;
    group_sizes_[static_cast<size_t>(piece.group)] += piece.size;
  }

  double Distance(const Piece& piece, int group) const {
    return (piece.sum / piece.size -
            group_sums_.row(group) / group_sizes_[static_cast<size_t>(group)])
        .squaredNorm();
  }

  // Every loose piece that touches one that stays joins it; then that one stays as well. A piece
  // among loose ones waits for the next round. False: nothing was loose.
  bool MoveARound(int* moved) {
    Vector<int> choice(pieces_.size(), kNone);
    const auto offer = [&](int from, int to) {
      const Piece& piece = PieceOf(from);
      const Piece& other = PieceOf(to);
      if (piece.stays || !other.stays) return;
      int& best = choice[static_cast<size_t>(piece_of_[static_cast<size_t>(from)])];
      if (best == other.group) return;
      const double distance = Distance(piece, other.group);
      if (best == kNone || distance < Distance(piece, best) ||
          (distance == Distance(piece, best) && other.group < best)) {
        best = other.group;
      }
    };
    ForEachEdge(mesh_, [&](int a, int b) {
      offer(a, b);
      offer(b, a);
    });
    bool any = false;
    for (size_t p = 0; p < pieces_.size(); ++p) {
      if (choice[p] == kNone) continue;
      any = true;
      pieces_[p].group = choice[p];
      pieces_[p].stays = true;
      *moved += pieces_[p].size;
    }
    for (size_t p = 0; p < pieces_.size(); ++p) {
      if (choice[p] != kNone) AddToGroup(pieces_[p]);
    }
    return any;
  }

  const geometry::SolveMesh& mesh_;
  const Eigen::MatrixXd& weights_;
  Vector<int>& group_;
  Vector<int> piece_of_;  // [V]
  Vector<Piece> pieces_;
  Eigen::MatrixXd group_sums_;  // G x H: of what stays
  Vector<int> group_sizes_;
};

}  // namespace

int ConnectGroups(const geometry::SolveMesh& mesh, const Eigen::MatrixXd& weights, int num_groups,
                  Vector<int>* vertex_group) {
  return Repair(mesh, weights, num_groups, vertex_group).Run();
}

}  // namespace limber::bake
