#include "pipeline/accuracy_character.h"

#include "bake/bake.h"
#include "bake/resolve_handles.h"
#include "bake/write_baked.h"
#include "core/vector.h"
#include "geometry/bridges.h"
#include "geometry/weld.h"
#include "import/import_gltf.h"
#include "import/pack_obj.h"
#include "load/rig_loader.h"
#include "skin/skin_positions.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace limber::test {
namespace {

Eigen::Vector3d ToEigen(Vec3 v) {
  return {v.x, v.y, v.z};
}

Vec3 FromEigen(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

Result<std::shared_ptr<const Rig>> BakeAndLoad(const std::filesystem::path& source,
                                               const std::filesystem::path& file, int num_handles,
                                               bool rotations) {
  Result<bake::RawCharacter> raw = bake::ImportGltf(source);
  if (!raw.ok()) return raw.status();
  geometry::SolveMesh mesh = geometry::WeldMesh(raw->shapes, raw->triangles, 0);
  geometry::ConnectComponents(&mesh);
  bake::BakeOptions options;
  options.rotations = rotations;
  Result<bake::BakedCharacter> baked =
      bake::Bake(*raw, bake::ChooseHandles(*raw, mesh, num_handles), options, {});
  if (!baked.ok()) return baked.status();
  LIMBER_RETURN_IF_ERROR(bake::WriteBaked(source, *raw, *baked, file));
  return LoadRig(file);
}

}  // namespace

std::filesystem::path PackHorse(const TemporaryFolder& folder, const std::string& name) {
  const std::filesystem::path data = SharedDataFolder() / "horse";
  const Vector<std::filesystem::path> poses = {data / "horse-01.obj", data / "horse-02.obj",
                                               data / "horse-03.obj", data / "horse-05.obj"};
  std::filesystem::path packed = folder.path() / (name + ".glb");
  const Status status = bake::PackObj(data / "horse_ref.obj", poses, {}, packed);
  EXPECT_TRUE(status.ok()) << status.message();
  return packed;
}

std::optional<AccuracyCharacter> AccuracyCharacter::Make(const std::filesystem::path& source,
                                                         int num_handles, bool rotations) {
  const std::filesystem::path folder = std::filesystem::path(LIMBER_BINARY_DIR) / "pictures";
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  const std::filesystem::path file = folder / (source.stem().string() + ".glb");
  Result<std::shared_ptr<const Rig>> rig = BakeAndLoad(source, file, num_handles, rotations);
  EXPECT_TRUE(rig.ok()) << rig.status().message();
  if (!rig.ok()) return std::nullopt;
  Result<PoseState> state = PoseState::Create(*rig);
  EXPECT_TRUE(state.ok()) << state.status().message();
  if (!state.ok()) return std::nullopt;
  AccuracyCharacter character;
  character.rig_ = *rig;
  character.baked_file_ = file;
  character.state_.emplace(std::move(state).value());
  character.options_.rotations = rotations;

  const SkinMesh& mesh = character.rig_->mesh();
  for (size_t t = 0; t < mesh.triangles.size(); t += 3) {
    for (size_t c = 0; c < 3; ++c) {
      const uint32_t a = mesh.solve_vertex[mesh.triangles[t + c]];
      const uint32_t b = mesh.solve_vertex[mesh.triangles[t + (c + 1) % 3]];
      if (a < b) character.edges_.emplace_back(a, b);
    }
  }
  character.edge_length_.assign(character.edges_.size(), 0);
  for (int s = 0; s < character.rig_->num_shapes(); ++s) {
    const Points shape = character.Shape(s);
    for (size_t e = 0; e < character.edges_.size(); ++e) {
      const auto [a, b] = character.edges_[e];
      character.edge_length_[e] = std::max(character.edge_length_[e], (shape[a] - shape[b]).norm());
    }
  }
  character.last_ = character.Deformed();
  return character;
}

Points AccuracyCharacter::Shape(int shape) const {
  const SkinMesh& mesh = rig_->mesh();
  Points points;
  for (uint32_t v = 0; v < mesh.num_solve_vertices; ++v) {
    const size_t at = static_cast<size_t>(shape) * mesh.num_solve_vertices + v;
    points.push_back(ToEigen(rig_->ToMesh(mesh.shape_positions[at])));
  }
  return points;
}

int AccuracyCharacter::FindShape(const std::string& name) const {
  const Vector<String>& names = rig_->tables().shape_names;
  const auto found = std::find(names.begin(), names.end(), String(name));
  EXPECT_NE(found, names.end()) << "no shape named " << name;
  return found == names.end() ? 0 : static_cast<int>(found - names.begin());
}

Points AccuracyCharacter::Deformed() const {
  Vector<Vec3> positions(rig_->mesh().num_solve_vertices);
  EXPECT_TRUE(SkinPositionsReference(rig_->mesh(), state_->transforms(), positions).ok());
  Points points;
  for (const Vec3& position : positions)
    points.push_back(ToEigen(position));
  return points;
}

void AccuracyCharacter::DragTo(const Points& goal, int steps,
                               const std::function<void()>& after_frame) {
  Vector<Eigen::Vector3d> from;
  for (int h = 0; h < rig_->num_handles(); ++h)
    from.push_back(ToEigen(state_->target(h)));
  for (int step = 1; step <= steps; ++step) {
    const double fraction = static_cast<double>(step) / steps;
    for (int h = 0; h < rig_->num_handles(); ++h) {
      const RigHandle& handle = rig_->tables().handles[static_cast<size_t>(h)];
      const Eigen::Vector3d& start = from[static_cast<size_t>(h)];
      EXPECT_TRUE(
          state_->SetTarget(h, FromEigen(start + fraction * (goal[handle.vertex] - start))).ok());
    }
    EXPECT_TRUE(state_->Solve(options_, nullptr).ok());
    RecordFrame();
    if (after_frame) after_frame();
  }
}

PoseReport AccuracyCharacter::Settle(int most) {
  PoseOptions options = options_;
  options.iterations = most;
  options.settle_tolerance = 1e-7;
  PoseReport report;
  EXPECT_TRUE(state_->Solve(options, &report).ok());
  return report;
}

void AccuracyCharacter::RecordFrame() {
  frames_ += frames_.empty() ? "" : ",\n";
  frames_ += R"({"targets": {)";
  for (int h = 0; h < rig_->num_handles(); ++h) {
    const Vec3 p = state_->target(h);
    char line[256];
    std::snprintf(line, sizeof line, "%s\"%s\": [%.9g, %.9g, %.9g]", h == 0 ? "" : ", ",
                  rig_->tables().handles[static_cast<size_t>(h)].name.c_str(), double{p.x},
                  double{p.y}, double{p.z});
    frames_ += line;
  }
  frames_ += "}}";
}

void AccuracyCharacter::KeepFrames() const {
  std::filesystem::path file = baked_file_;
  file.replace_extension(".json");
  std::ofstream(file) << "{\"frames\": [\n" << frames_ << "\n]}\n";
}

double AccuracyCharacter::RmsPercent(const Points& goal) const {
  const Points deformed = Deformed();
  double sum = 0;
  for (size_t v = 0; v < goal.size(); ++v)
    sum += (deformed[v] - goal[v]).squaredNorm();
  return 100 * std::sqrt(sum / static_cast<double>(goal.size())) /
         static_cast<double>(rig_->diagonal());
}

void AccuracyCharacter::ExpectSound(double longest, double jump) {
  const Points now = Deformed();
  const double diagonal = rig_->diagonal();
  double largest_motion = 0;
  for (size_t v = 0; v < now.size(); ++v) {
    ASSERT_TRUE(now[v].allFinite()) << "vertex " << v;
    largest_motion = std::max(largest_motion, (now[v] - last_[v]).norm());
  }
  EXPECT_LE(largest_motion, jump * diagonal);
  double worst = 0;
  for (size_t e = 0; e < edges_.size(); ++e) {
    const auto [a, b] = edges_[e];
    const double allowed = edge_length_[e] + 1e-3 * diagonal;
    worst = std::max(worst, (now[a] - now[b]).norm() / allowed);
  }
  EXPECT_LE(worst, longest);
  last_ = now;
}

}  // namespace limber::test
