// Characters as they come from artists: every defect alone, pairs and all of them together. Each
// gives a sound bake; what cannot be baked is refused by its cause.
#include "bake/bake.h"
#include "core/vector.h"
#include "editor_tools/bake/sound_bake.h"
#include "support/test_meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>

namespace limber::bake {
namespace {

using Random = std::mt19937;

// A character that is being spoiled; vertices are added in all shapes at once.
struct Patient {
  RawCharacter raw = test::MakeBendCylinder(10, 14);
  uint32_t num_good = static_cast<uint32_t>(raw.num_draw_vertices());

  // A vertex beside another one, by the same offset in every shape.
  uint32_t Add(uint32_t beside, const Eigen::RowVector3d& offset) {
    const auto added = static_cast<uint32_t>(raw.num_draw_vertices());
    for (PointMatrix& shape : raw.shapes) {
      shape.conservativeResize(added + 1, 3);
      shape.row(added) = shape.row(beside) + offset;
    }
    return added;
  }

  // A vertex between two others: on their edge in every shape.
  uint32_t AddBetween(uint32_t a, uint32_t b, double share) {
    const uint32_t added = Add(a, {0, 0, 0});
    for (PointMatrix& shape : raw.shapes)
      shape.row(added) += share * (shape.row(b) - shape.row(a));
    return added;
  }

  void Triangle(uint32_t a, uint32_t b, uint32_t c) {
    raw.triangles.insert(raw.triangles.end(), {a, b, c});
  }

  uint32_t num_triangles() const { return static_cast<uint32_t>(raw.triangles.size() / 3); }

  uint32_t* Corners(uint32_t triangle) { return raw.triangles.data() + 3 * size_t{triangle}; }

  // What follows from the rest.
  RawCharacter Discharged() {
    const auto count = static_cast<uint32_t>(raw.num_draw_vertices());
    raw.num_source_vertices = count;
    raw.source_vertex.resize(count);
    for (uint32_t v = 0; v < count; ++v)
      raw.source_vertex[v] = v;
    raw.primitives[0].num_vertices = count;
    raw.primitives[0].num_triangles = num_triangles();
    return raw;
  }
};

struct Defect {
  const char* name;
  std::function<void(Patient*, Random*)> spoil;
  bool harmless = false;  // the weights of the good vertices stay what they were
};

void SplitSeams(Patient* patient, Random* random) {
  const uint32_t last = patient->num_triangles();
  for (uint32_t t = 0; t < last; ++t) {
    if ((*random)() % 3 != 0) continue;
    uint32_t& corner = patient->Corners(t)[(*random)() % 3];
    corner = patient->Add(corner, {0, 0, 0});
  }
}

void AddEyes(Patient* patient, Random* random) {
  for (int eye = 0; eye < 3; ++eye) {
    const uint32_t beside = (*random)() % patient->num_good;
    uint32_t corners[4];
    const double size = 0.05;
    const Eigen::RowVector3d offsets[4] = {
        {0.06, 0, 0}, {0.06 + size, 0, 0}, {0.06, size, 0}, {0.06, 0, size}};
    for (int i = 0; i < 4; ++i)
      corners[i] = patient->Add(beside, offsets[i]);
    for (int skipped = 0; skipped < 4; ++skipped)
      patient->Triangle(corners[(skipped + 1) % 4], corners[(skipped + 2) % 4],
                        corners[(skipped + 3) % 4]);
  }
}

void AddFins(Patient* patient, Random* random) {
  for (int fin = 0; fin < 4; ++fin) {
    const uint32_t* corners = patient->Corners((*random)() % patient->num_triangles());
    const uint32_t a = corners[0], b = corners[1];
    patient->Triangle(a, b, patient->Add(a, {0.05, 0.02, 0.08}));
  }
}

void AddBowTies(Patient* patient, Random* random) {
  for (int tie = 0; tie < 4; ++tie) {
    const uint32_t knot = (*random)() % patient->num_good;
    const uint32_t a = patient->Add(knot, {0.1, 0, 0}), b = patient->Add(knot, {0.1, 0.1, 0});
    patient->Triangle(knot, a, b);
  }
}

void FlipTriangles(Patient* patient, Random* random) {
  for (uint32_t t = 0; t < patient->num_triangles(); ++t) {
    if ((*random)() % 3 == 0) std::swap(patient->Corners(t)[0], patient->Corners(t)[1]);
  }
}

void AddFlatTriangles(Patient* patient, Random* random) {
  for (int i = 0; i < 6; ++i) {
    const uint32_t* corners = patient->Corners((*random)() % patient->num_triangles());
    const uint32_t a = corners[0], b = corners[1];
    patient->Triangle(a, b, patient->AddBetween(a, b, 0.4));
    patient->Triangle(a, a, b);
    patient->Triangle(a, b, patient->Add(a, {0, 0, 0}));
  }
}

// Triangles cut from a corner to just beside another.
void AddNeedles(Patient* patient, Random* random) {
  for (int i = 0; i < 6; ++i) {
    const uint32_t cut_one = (*random)() % patient->num_triangles();
    const uint32_t a = patient->Corners(cut_one)[0], b = patient->Corners(cut_one)[1];
    const uint32_t cut = patient->AddBetween(b, patient->Corners(cut_one)[2], 1e-4);
    patient->Corners(cut_one)[1] = cut;
    patient->Triangle(a, b, cut);
  }
}

void CopyTriangles(Patient* patient, Random* random) {
  const uint32_t last = patient->num_triangles();
  for (uint32_t t = 0; t < last; ++t) {
    const uint32_t a = patient->Corners(t)[0], b = patient->Corners(t)[1],
                   c = patient->Corners(t)[2];
    const uint32_t kind = (*random)() % 4;
    if (kind == 0) patient->Triangle(a, b, c);
    if (kind == 1) patient->Triangle(b, a, c);
  }
}

void AddUnusedVertices(Patient* patient, Random* random) {
  for (int i = 0; i < 5; ++i)
    patient->Add((*random)() % patient->num_good, {0, 0, 0});
}

void PunchHoles(Patient* patient, Random* random) {
  Vector<uint32_t> kept;
  for (uint32_t t = 0; t < patient->num_triangles(); ++t) {
    const uint32_t* corners = patient->Corners(t);
    if ((*random)() % 8 != 0) kept.insert(kept.end(), corners, corners + 3);
  }
  patient->raw.triangles = kept;
}

void AddCrumbs(Patient* patient, Random* random) {
  for (int i = 0; i < 4; ++i) {
    const uint32_t beside = (*random)() % patient->num_good;
    const uint32_t a = patient->Add(beside, {1, 0, 0}), b = patient->Add(beside, {1.01, 0, 0});
    patient->Triangle(a, b, patient->Add(beside, {1, 0.01, 0}));
  }
}

void RepeatAnExample(Patient* patient, Random*) {
  patient->raw.shapes.push_back(patient->raw.shapes[1]);
  patient->raw.shape_names.emplace_back("again");
}

void MirrorAnExample(Patient* patient, Random*) {
  patient->raw.shapes.push_back(patient->raw.shapes[1]);
  patient->raw.shapes.back().col(2) *= -1;
  patient->raw.shape_names.emplace_back("mirrored");
}

// A target that an exporter left empty, or scaled away.
void CollapseAnExample(Patient* patient, Random*) {
  patient->raw.shapes.push_back(patient->raw.shapes[0]);
  patient->raw.shapes.back().leftCols(2).setZero();  // all on a line
  patient->raw.shape_names.emplace_back("line");
}

const Vector<Defect>& Defects() {
  static const Vector<Defect> defects = {
      {"seams", SplitSeams, true},
      {"loose eyes", AddEyes},
      {"fins", AddFins},
      {"bow ties", AddBowTies},
      {"flipped triangles", FlipTriangles, true},
      {"flat triangles", AddFlatTriangles},
      {"needles", AddNeedles},
      {"copied triangles", CopyTriangles},
      {"unused vertices", AddUnusedVertices, true},
      {"holes", PunchHoles},
      {"crumbs", AddCrumbs},
      {"a repeated example", RepeatAnExample, true},
      {"a mirrored example", MirrorAnExample},
      {"a collapsed example", CollapseAnExample},
  };
  return defects;
}

void ExpectSound(const RawCharacter& raw) {
  test::ExpectSoundBake(raw, raw.marked_handles);
}

TEST(BrokenMeshes, EachDefectAlone) {
  for (const Defect& defect : Defects()) {
    SCOPED_TRACE(defect.name);
    Patient patient;
    Random random(3);
    defect.spoil(&patient, &random);
    ExpectSound(patient.Discharged());
  }
}

TEST(BrokenMeshes, TwoDefectsTogether) {
  Random random(5);
  for (size_t first = 0; first < Defects().size(); ++first) {
    const size_t second = (first + 1 + random() % (Defects().size() - 1)) % Defects().size();
    SCOPED_TRACE(std::string(Defects()[first].name) + " and " + Defects()[second].name);
    Patient patient;
    Defects()[first].spoil(&patient, &random);
    Defects()[second].spoil(&patient, &random);
    ExpectSound(patient.Discharged());
  }
}

TEST(BrokenMeshes, AllDefectsTogether) {
  // The last one brings the weights to where rounding stops them (seen with fused arithmetic).
  for (const uint32_t seed : {1u, 2u, 3u, 34u}) {
    SCOPED_TRACE(seed);
    Patient patient;
    Random random(seed);
    for (const Defect& defect : Defects())
      defect.spoil(&patient, &random);
    ExpectSound(patient.Discharged());
  }
}

TEST(BrokenMeshes, HarmlessDefects_ChangeNoWeight) {
  const RawCharacter good = Patient().Discharged();
  const auto expected = Bake(good, good.marked_handles, {}, {});
  ASSERT_TRUE(expected.ok());
  for (const Defect& defect : Defects()) {
    if (!defect.harmless) continue;
    SCOPED_TRACE(defect.name);
    Patient patient;
    Random random(7);
    defect.spoil(&patient, &random);
    const RawCharacter raw = patient.Discharged();
    const auto baked = Bake(raw, raw.marked_handles, {}, {});
    ASSERT_TRUE(baked.ok()) << baked.status().message();
    const auto num_handles = static_cast<size_t>(baked->mesh.num_handles);
    for (uint32_t d = 0; d < patient.num_good; ++d) {
      const size_t v = baked->mesh.solve_vertex[d], old = expected->mesh.solve_vertex[d];
      for (size_t h = 0; h < num_handles; ++h) {
        EXPECT_NEAR(baked->mesh.weights[v * num_handles + h],
                    expected->mesh.weights[old * num_handles + h], 1e-6);
      }
    }
  }
}

// Units and places that files come in: a millimetre or a kilometre, far from the origin.
TEST(BrokenMeshes, AnyScaleAndPlace) {
  for (const double scale : {1e-6, 1e-3, 1e3, 1e6}) {
    for (const double away : {0.0, 100.0}) {
      SCOPED_TRACE(std::to_string(scale) + " at " + std::to_string(away));
      Patient patient;
      for (PointMatrix& shape : patient.raw.shapes)
        shape = scale * (shape.rowwise() + Eigen::RowVector3d(away, -away, away));
      ExpectSound(patient.Discharged());
    }
  }
}

TEST(BrokenMeshes, NothingToBake_IsRefusedByItsCause) {
  const auto refusal = [](const RawCharacter& raw) {
    return Bake(raw, raw.marked_handles, {}, {}).status();
  };
  Patient empty, flat, point, lost;
  empty.raw.triangles.clear();
  EXPECT_EQ(refusal(empty.Discharged()).code(), StatusCode::kDegenerate);
  for (uint32_t t = 0; t < flat.num_triangles(); ++t)
    flat.Corners(t)[1] = flat.Corners(t)[0];
  EXPECT_EQ(refusal(flat.Discharged()).code(), StatusCode::kDegenerate);
  for (PointMatrix& shape : point.raw.shapes)
    shape.setZero();
  EXPECT_EQ(refusal(point.Discharged()).code(), StatusCode::kDegenerate);
  lost.raw.shapes[1](17, 2) = std::nan("");
  const Status status = refusal(lost.Discharged());
  EXPECT_EQ(status.code(), StatusCode::kMalformed);
  EXPECT_NE(status.message().find(lost.raw.shape_names[1]), std::string::npos);
}

}  // namespace
}  // namespace limber::bake
