// The tables of real bakes, packed, written and loaded: how exact they come back, what they take,
// and what a damaged file does.
#include "bake/pack_tables.h"
#include "bake/write_baked.h"
#include "core/vector.h"
#include "editor_tools/write/synthetic_bake.h"
#include "import/import_gltf.h"
#include "load/rig_loader.h"
#include "rig/rig_fields.h"
#include "support/temporary_folder.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <string_view>

namespace limber::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Numbers = Vector<float>;

struct Written {
  bake::BakedCharacter baked;
  fs::path file;
};

// A shipped character, baked into `folder`.
Written BakeShipped(const std::string& name, const bake::BakeOptions& options,
                    const TemporaryFolder& folder) {
  const fs::path source = fs::path(LIMBER_SOURCE_DIR) / "content/characters" / (name + ".glb");
  Written written;
  auto raw = bake::ImportGltf(source);
  EXPECT_TRUE(raw.ok()) << raw.status().message();
  auto baked = bake::Bake(*raw, raw->marked_handles, options, {});
  EXPECT_TRUE(baked.ok()) << baked.status().message();
  written.file = folder.path() / (name + ".gltf");
  const Status status = bake::WriteBaked(source, *raw, *baked, written.file);
  EXPECT_TRUE(status.ok()) << status.message();
  written.baked = std::move(*baked);
  return written;
}

float Largest(const Numbers& table) {
  float largest = 0;
  for (const float number : table)
    largest = std::max(largest, std::abs(number));
  return largest;
}

uint64_t FloatBytes(const RigTables& tables) {
  uint64_t count = 0;
  VisitRigTables(tables,
                 [&](const char*, const Numbers& table, const auto&) { count += table.size(); });
  return count * sizeof(float);
}

// Each number against the largest of its table; where a mode's transforms have a size of their own,
// of its column.
void ExpectClose(const char* name, const Numbers& written, const Numbers& loaded, size_t columns,
                 double tolerance) {
  ASSERT_EQ(written.size(), loaded.size()) << name;
  Vector<float> largest(columns, 0);
  for (size_t i = 0; i < written.size(); ++i)
    largest[i % columns] = std::max(largest[i % columns], std::abs(written[i]));
  for (size_t i = 0; i < written.size(); ++i) {
    ASSERT_NEAR(loaded[i], written[i], tolerance * static_cast<double>(largest[i % columns]))
        << name << " " << i;
  }
}

// |U a|^2 for one packed triangle of size m.
double Energy(const float* packed, const Eigen::VectorXd& a) {
  double energy = 0;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    double sum = 0;
    for (Eigen::Index j = i; j < a.size(); ++j)
      sum += static_cast<double>(*packed++) * a[j];
    energy += sum * sum;
  }
  return energy;
}

struct PackedCase {
  const char* character;
  bool rotations;
  int influences;
};

class PackedTables : public testing::TestWithParam<PackedCase> {};

TEST_P(PackedTables, LoadedAgain_AreAsExactAsFloats) {
  const TemporaryFolder folder;
  bake::BakeOptions options;
  options.rotations = GetParam().rotations;
  options.influences = GetParam().influences;
  const Written written = BakeShipped(GetParam().character, options, folder);
  const auto rig = LoadRig(written.file);
  ASSERT_TRUE(rig.ok()) << rig.status().message();
  const RigTables &before = written.baked.tables, &after = (*rig)->tables();
  Vector<const Numbers*> loaded;
  VisitRigTables(after, [&](const char*, const Numbers& t, const auto&) { loaded.push_back(&t); });
  size_t index = 0;
  VisitRigTables(before, [&](const char* name, const Numbers& table, const Vector<int64_t>& shape) {
    const Numbers& other = *loaded[index++];
    const std::string_view is = name;
    if (is == "singleGroupFactors" || is == "singleEdges") return;  // remade: by energies, below
    const bool by_columns = is == "modeTransforms";
    const bool is_energy = is == "modeEdges" || is == "residualFactor";
    ExpectClose(name, table, other, by_columns ? static_cast<size_t>(shape.back()) : 1,
                is_energy ? 0x1p-23 : 0x1p-24);
  });
  // Sums of products of up to a few dozen packed numbers, of which the largest is `factor`.
  const float factor = Largest(written.baked.local_factors.factors);
  ASSERT_EQ(before.single_edges.size(), after.single_edges.size());
  for (size_t i = 0; i < before.single_edges.size(); ++i)
    ASSERT_NEAR(after.single_edges[i], before.single_edges[i], 0x1p-20 * std::pow(factor, 2)) << i;
  const Eigen::Index m = before.num_single_modes + before.dimension;
  const auto size = static_cast<size_t>(m * (m + 1) / 2);
  for (size_t at = 0; at < before.single_group_factors.size(); at += size) {
    const Eigen::VectorXd a = Eigen::VectorXd::Random(m);
    const double energy = Energy(before.single_group_factors.data() + at, a);
    EXPECT_NEAR(Energy(after.single_group_factors.data() + at, a), energy, 1e-5 * energy);
  }
}

INSTANTIATE_TEST_SUITE_P(Shipped, PackedTables,
                         testing::Values(PackedCase{"fox", true, 0}, PackedCase{"fox", false, 0},
                                         PackedCase{"square", true, 0},
                                         PackedCase{"dragonlet", true, 4}),
                         [](const auto& test) {
                           return std::string(test.param.character) +
                                  (test.param.rotations ? "" : "WithoutRotations");
                         });

TEST(PackedTableSize, IsWhatTheFileHolds_AndHalfOfFloats) {
  const TemporaryFolder folder;
  const Written written = BakeShipped("dragonlet", {}, folder);
  const Json json = ReadGltfJson(written.file);
  uint64_t in_file = 0;
  for (const Json& table : json["extensions"][kRigExtensionName]["rigs"][0]["tables"]) {
    const Json& accessor = json["accessors"][table["accessor"].get<size_t>()];
    EXPECT_EQ(accessor["componentType"], 5121);
    in_file += accessor["count"].get<uint64_t>();
  }
  const auto packed = bake::PackRigTables(written.baked.tables, written.baked.local_factors);
  ASSERT_TRUE(packed.ok()) << packed.status().message();
  EXPECT_EQ(in_file, bake::NumBytes(*packed));
  EXPECT_LT(in_file, FloatBytes(written.baked.tables) / 2);
  const uint64_t attributes =
      (4 * ((written.baked.tables.handles.size() + 3) / 4) + 2) * sizeof(float);
  EXPECT_EQ(written.baked.cost.file_bytes,
            in_file + attributes * written.baked.mesh.num_draw_vertices);
}

// What tells two examples apart that are nearly alike would be lost in steps fit for others.
TEST(PackRigTables, ExamplesNearlyAlike_GetFinerSteps) {
  const TemporaryFolder folder;
  const auto raw = bake::ImportGltf(WritePlainSource(folder.path()));
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  SyntheticOptions options;
  options.residual_rank = 4;
  bake::BakedCharacter baked = MakeSyntheticBake(*raw, options);
  RigTables& t = baked.tables;
  const auto exponent_of = [&](const char* name) {
    const auto packed = bake::PackRigTables(t, {});
    EXPECT_TRUE(packed.ok()) << packed.status().message();
    for (const bake::PackedTable& table : *packed) {
      if (table.name == name) return table.exponent;
    }
    ADD_FAILURE() << name;
    return 0;
  };
  const int apart = exponent_of("residualFactor"), edges_apart = exponent_of("modeEdges");
  // Shape 1 becomes shape 0 but for a hundredth.
  const auto blend = [&t](Numbers* table, size_t size) {
    for (size_t i = 0; i < table->size(); ++i) {
      if (i / size % static_cast<size_t>(t.num_shapes()) == 1)
        (*table)[i] = (*table)[i - size] + 0.01f * (*table)[i];
    }
  };
  const auto k = static_cast<size_t>(t.dimension);
  blend(&t.residual_factor, k);
  blend(&t.mode_edges, k * static_cast<size_t>(t.num_modes));
  EXPECT_LE(exponent_of("residualFactor"), apart - 2);
  EXPECT_LE(exponent_of("modeEdges"), edges_apart - 2);
}

TEST(PackRigTables, WrongNumbers_AreRefusedByName) {
  const TemporaryFolder folder;
  const auto raw = bake::ImportGltf(WritePlainSource(folder.path()));
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  const bake::BakedCharacter baked = MakeSyntheticBake(*raw, {});
  RigTables bad = baked.tables;
  bad.mode_edges[5] = std::numeric_limits<float>::infinity();
  Status status = bake::PackRigTables(bad, {}).status();
  EXPECT_EQ(status.code(), StatusCode::kInternal);
  EXPECT_EQ(status.message(), "tables.modeEdges: element 5 is not a finite number");
  bad = baked.tables;
  bad.single_edges.pop_back();
  status = bake::PackRigTables(bad, {}).status();
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(status.message().find("tables.singleEdges"), std::string::npos);
}

class DamagedTables : public testing::Test {
 protected:
  DamagedTables() : json_(ReadGltfJson(BakeShipped("square", {}, folder_).file)) {}

  // What loading says after `damage` to the rig's tables.
  Status LoadAfter(const std::function<void(Json*)>& damage, const RigLoadOptions& options = {}) {
    Json json = json_;
    damage(&json["extensions"][kRigExtensionName]["rigs"][0]["tables"]);
    const std::string text = json.dump();
    return LoadRigFromMemory({reinterpret_cast<const uint8_t*>(text.data()), text.size()},
                             "damaged", options)
        .status();
  }

  TemporaryFolder folder_;
  Json json_;
};

TEST_F(DamagedTables, AreRefusedByName) {
  struct Damage {
    const char* table;
    std::function<void(Json*)> damage;
    StatusCode code;
  };

  const auto exponent = [](int value) { return [value](Json* t) { (*t)["exponent"] = value; }; };
  const Damage damages[] = {
      {"residualColumns", exponent(1), StatusCode::kMalformed},   // some beyond the last column
      {"residualColumns", exponent(-1), StatusCode::kMalformed},  // some between two columns
      {"groupHandles", exponent(1), StatusCode::kMalformed},
      {"modeExponents", exponent(8), StatusCode::kMalformed},  // beyond floats
      {"singleModeExponents", exponent(-3), StatusCode::kMalformed},
      {"modeEdges", exponent(105), StatusCode::kLimitExceeded},
      {"modeEdges", exponent(-127), StatusCode::kMalformed},
      {"modeEdges", [](Json* t) { t->erase("exponent"); }, StatusCode::kMalformed},
      {"groupFactors", [](Json* t) { (*t)["shape"][0] = 1; }, StatusCode::kMalformed},
      {"groupHandles", [](Json* t) { (*t)["accessor"] = 0; }, StatusCode::kMalformed},
  };
  EXPECT_TRUE(LoadAfter([](Json*) {}).ok());
  for (const Damage& damage : damages) {
    const Status status = LoadAfter([&](Json* tables) { damage.damage(&(*tables)[damage.table]); });
    EXPECT_EQ(status.code(), damage.code) << damage.table << ": " << status.message();
    EXPECT_NE(status.message().find(damage.table), std::string::npos) << status.message();
  }
  const Status status = LoadAfter([](Json* tables) { tables->erase("groupHandles"); });
  EXPECT_EQ(status.code(), StatusCode::kMalformed);
  EXPECT_NE(status.message().find("groupHandles: it is missing"), std::string::npos);
}

TEST_F(DamagedTables, MoreNumbersThanAllowed_AreRefusedBeforeTheyAreMade) {
  RigLoadOptions options;
  options.limits.max_table_numbers = 100;
  EXPECT_EQ(LoadAfter([](Json*) {}, options).code(), StatusCode::kLimitExceeded);
}

TEST(LoadRig, AnyDamagedByte_IsAStatusOrARig) {
  const TemporaryFolder folder;
  const fs::path source = WritePlainSource(folder.path()), out = folder.path() / "out.glb";
  const auto raw = bake::ImportGltf(source);
  ASSERT_TRUE(raw.ok()) << raw.status().message();
  ASSERT_TRUE(bake::WriteBaked(source, *raw, MakeSyntheticBake(*raw, {}), out).ok());
  Vector<uint8_t> bytes = ReadBytes(out);
  std::mt19937 random(3);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    uint8_t& byte = bytes[20 + random() % (bytes.size() - 20)];
    const uint8_t old = byte;
    byte = static_cast<uint8_t>(random());
    if (!LoadRigFromMemory(bytes, "damaged").ok()) ++refused;
    byte = old;
  }
  EXPECT_GT(refused, 200);
}

}  // namespace
}  // namespace limber::test
