#include "load/rig_table_reader.h"

#include "core/vector.h"
#include "load/gltf_accessor.h"
#include "rig/local_group_factors.h"
#include "rig/packed_numbers.h"
#include "rig/rig_fields.h"

#include <cmath>
#include <string_view>
#include <utility>

namespace limber {
namespace {

using Numbers = Vector<float>;

std::string Place(const char* name) {
  return std::string("tables.") + name;
}

bool Has(const RigJson& rig, const char* name) {
  return rig.table_accessors.contains(name);
}

// The count that `shape` asks for. Sizes are below 2^23 each and few (rig_json.h).
Result<int64_t> CountOf(const GltfFile& file, const char* name, const Vector<int64_t>& shape) {
  const int64_t count = NumElements(shape);
  if (static_cast<uint64_t>(count) <= file.limits().max_table_numbers) return count;
  return Status(StatusCode::kLimitExceeded, Place(name) + ": " + std::to_string(count) +
                                                " numbers, the limit is " +
                                                std::to_string(file.limits().max_table_numbers));
}

// The table of that name, which must have that shape.
Result<Numbers> ReadTable(const GltfFile& file, const RigJson& rig, const char* name,
                          const Vector<int64_t>& shape) {
  const Result<int64_t> count = CountOf(file, name, shape);
  if (!count.ok()) return count.status();
  const auto it = rig.table_accessors.find(name);
  if (it == rig.table_accessors.end()) {
    if (*count == 0) return Numbers();
    return Status(StatusCode::kMalformed, Place(name) + ": it is missing");
  }
  const RigJson::Table& table = it->second;
  if (table.shape != shape) {
    return Status(StatusCode::kMalformed,
                  Place(name) + ".shape: it does not follow from the rig's counts");
  }
  AccessorRequest request{table.accessor, 1, Place(name)};
  if (!table.exponent) {
    request.expected_count = *count;
    return ReadFloats(file, request);
  }
  const auto bytes = ViewBytes(file, request);
  if (!bytes.ok()) return bytes.status();
  auto numbers = UnpackNumbers(*bytes, static_cast<size_t>(*count), *table.exponent);
  if (!numbers.ok()) return numbers.status().WithContext(Place(name));
  return numbers;
}

// Puts the columns of F where they belong, from the order in which the file has them.
Status OrderResidual(const GltfFile& file, RigJson* rig) {
  Numbers& factor = rig->tables.residual_factor;
  if (!Has(*rig, kResidualColumnsTable) || factor.empty()) return {};
  const auto rows = static_cast<size_t>(rig->tables.residual_rank);
  const size_t columns = factor.size() / rows;
  const auto order = ReadTable(file, *rig, kResidualColumnsTable, {static_cast<int64_t>(columns)});
  if (!order.ok()) return order.status();
  Vector<bool> taken(columns, false);
  Numbers ordered(factor.size());
  for (size_t j = 0; j < columns; ++j) {
    const float number = (*order)[j];
    const bool is_column = number >= 0 && number < static_cast<float>(columns) &&
                           number == static_cast<float>(static_cast<size_t>(number));
    if (!is_column || taken[static_cast<size_t>(number)]) {
      return Error(StatusCode::kMalformed,
                   "tables.%s: element %zu is %g; expected each of 0 to "
                   "%zu once",
                   kResidualColumnsTable, j, static_cast<double>(number), columns - 1);
    }
    const auto column = static_cast<size_t>(number);
    taken[column] = true;
    for (size_t row = 0; row < rows; ++row)
      ordered[row * columns + column] = factor[row * columns + j];
  }
  factor = std::move(ordered);
  return {};
}

// Gives the columns of `table`, matrices of equally many rows, the scale that the file has taken
// out. exponents_shape: [number of matrices, columns], or [columns] for one.
Status ScaleColumns(const GltfFile& file, const RigJson& rig, const char* name,
                    const Vector<int64_t>& exponents_shape, Numbers* table) {
  if (!Has(rig, name)) return {};
  const auto exponents = ReadTable(file, rig, name, exponents_shape);
  if (!exponents.ok()) return exponents.status();
  constexpr float kMost = 126;
  for (size_t c = 0; c < exponents->size(); ++c) {
    const float exponent = (*exponents)[c];
    if (std::abs(exponent) <= kMost && exponent == std::trunc(exponent)) continue;
    return Error(StatusCode::kMalformed,
                 "tables.%s: element %zu is %g; expected a whole number "
                 "within -126 to 126",
                 name, c, static_cast<double>(exponent));
  }
  const auto columns = static_cast<size_t>(exponents_shape.back());
  const size_t matrices = exponents->size() / columns, size = table->size() / matrices;
  for (size_t i = 0; i < table->size(); ++i) {
    const float exponent = (*exponents)[i / size * columns + i % columns];
    (*table)[i] = std::ldexp((*table)[i], static_cast<int>(exponent));
  }
  return {};
}

Status ScaleTransforms(const GltfFile& file, RigJson* rig) {
  RigTables& t = rig->tables;
  LIMBER_RETURN_IF_ERROR(ScaleColumns(file, *rig, kModeExponentsTable, {int64_t{1} + t.num_modes},
                                      &t.mode_transforms));
  return ScaleColumns(file, *rig, kSingleModeExponentsTable,
                      {int64_t{t.num_shapes()}, int64_t{1} + t.num_single_modes},
                      &t.single_mode_transforms);
}

// The energies of single groups from those of their handles.
Status ReadLocalFactors(const GltfFile& file, RigJson* rig) {
  RigTables& t = rig->tables;
  LocalGroupFactors local;
  auto handles =
      ReadTable(file, *rig, kGroupHandlesTable, {int64_t{t.num_groups}, int64_t{t.num_handles()}});
  if (!handles.ok()) return handles.status();
  local.group_handles = std::move(*handles);
  const Result<int64_t> count = NumLocalFactors(t, local.group_handles);
  if (!count.ok()) return count.status().WithContext("tables");
  auto factors = ReadTable(file, *rig, kGroupFactorsTable, {*count});
  if (!factors.ok()) return factors.status();
  local.factors = std::move(*factors);
  return ExpandLocalGroupFactors(local, &t).WithContext("tables");
}

bool StandsForLocal(std::string_view name) {
  return name == "singleEdges" || name == "singleGroupFactors";
}

}  // namespace

Status ReadRigTables(const GltfFile& file, int version, RigJson* rig) {
  const bool local = version >= 3 && Has(*rig, kGroupFactorsTable);
  Status status;
  VisitRigTables(rig->tables, [&](const char* name, Numbers& table, const Vector<int64_t>& shape) {
    if (!status.ok() || version < FirstVersionOfTable(name)) return;
    if (local && StandsForLocal(name)) {
      status = CountOf(file, name, shape).status();  // of what is made of them
      return;
    }
    Result<Numbers> numbers = ReadTable(file, *rig, name, shape);
    if (numbers.ok()) table = std::move(*numbers);
    status = numbers.status();
  });
  if (!status.ok()) return status;
  if (version < 3) return {};
  LIMBER_RETURN_IF_ERROR(OrderResidual(file, rig));
  LIMBER_RETURN_IF_ERROR(ScaleTransforms(file, rig));
  return local ? ReadLocalFactors(file, rig) : Status();
}

}  // namespace limber
