#include "bake/pack_tables.h"

#include "core/vector.h"
#include "rig/packed_numbers.h"
#include "rig/rig_fields.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <string_view>

namespace limber::bake {
namespace {

// Bits of energies below the largest: as single precision has them, and more where the examples are
// so alike that what tells them apart would be lost.
constexpr int kLeastEnergyBits = 23, kMostEnergyBits = 27;
// Below the largest difference of the example that differs least.
constexpr int kDifferenceBits = 19;
constexpr int kTransformBits = 24;
constexpr int kExact = 0;  // whole numbers

bool IsEnergy(std::string_view name) {
  return name == "modeEdges" || name == "residualFactor" || name == "singleEdges" ||
         name == "singleGroupFactors";
}

// What the loader makes of groupHandles and groupFactors.
bool FollowsFromLocal(std::string_view name) {
  return name == "singleEdges" || name == "singleGroupFactors";
}

class Packer {
 public:
  void Add(const char* name, Vector<int64_t> shape, std::span<const float> numbers, int exponent) {
    if (numbers.empty()) return;
    tables_.push_back({name, std::move(shape), exponent, PackNumbers(numbers, exponent)});
  }

  Vector<PackedTable> Take() { return std::move(tables_); }

 private:
  Vector<PackedTable> tables_;
};

// For each example shape the largest difference of its entries from the first shape's, raised into
// *differences. The table's last dimensions are [G][S][size].
void MeasureDifferences(std::span<const float> table, size_t num_shapes, size_t size,
                        Vector<float>* differences) {
  for (size_t i = 0; i < table.size(); ++i) {
    const size_t shape = i / size % num_shapes;
    const float difference = std::abs(table[i] - table[i - shape * size]);
    (*differences)[shape] = std::max((*differences)[shape], difference);
  }
}

int EnergyBits(const RigTables& t) {
  const auto num_shapes = static_cast<size_t>(t.num_shapes());
  const size_t axes = t.has_rotations ? static_cast<size_t>(t.dimension) : 1;
  Vector<float> differences(num_shapes, 0);
  MeasureDifferences(t.residual_factor, num_shapes, axes, &differences);
  const auto block = static_cast<size_t>(t.dimension) * static_cast<size_t>(t.num_modes);
  if (block > 0) MeasureDifferences(t.mode_edges, num_shapes, block, &differences);
  float largest = 0, least = std::numeric_limits<float>::infinity();
  for (const Vector<float>* table : {&t.residual_factor, &t.mode_edges}) {
    for (const float number : *table)
      largest = std::max(largest, std::abs(number));
  }
  for (size_t s = 1; s < num_shapes; ++s) {
    if (differences[s] > 0) least = std::min(least, differences[s]);  // zero: a copy, no example
  }
  if (!(largest > 0) || num_shapes < 2) return kLeastEnergyBits;
  const float wanted = static_cast<float>(kDifferenceBits) + std::log2(largest / least);
  return static_cast<int>(std::clamp(std::ceil(wanted), static_cast<float>(kLeastEnergyBits),
                                     static_cast<float>(kMostEnergyBits)));
}

// The columns of F in the order in which they end: with the rows of a pivoted factor a trapezoid.
Vector<size_t> OrderOfEnds(std::span<const float> factor, size_t columns) {
  Vector<size_t> ends(columns, 0), order(columns);
  for (size_t i = 0; i < factor.size(); ++i) {
    if (factor[i] != 0) ends[i % columns] = i / columns;
  }
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&ends](size_t a, size_t b) { return ends[a] < ends[b]; });
  return order;
}

void AddResidual(const RigTables& tables, const char* name, const Vector<int64_t>& shape, int bits,
                 Packer* packer) {
  const Vector<float>& factor = tables.residual_factor;
  if (factor.empty()) return;
  const size_t columns = factor.size() / static_cast<size_t>(tables.residual_rank);
  const Vector<size_t> order = OrderOfEnds(factor, columns);
  Vector<float> ordered(factor.size());
  for (size_t i = 0; i < factor.size(); ++i)
    ordered[i] = factor[i - i % columns + order[i % columns]];
  packer->Add(name, shape, ordered, PackingExponent(ordered, bits));
  packer->Add(kResidualColumnsTable, {static_cast<int64_t>(columns)},
              Vector<float>(order.begin(), order.end()), kExact);
}

// `table` holds matrices of `columns` columns and equally many rows, one after the other.
void AddTransforms(std::span<const float> table, const char* name, const Vector<int64_t>& shape,
                   const char* exponents_name, const Vector<int64_t>& exponents_shape,
                   Packer* packer) {
  if (table.empty()) return;
  const auto columns = static_cast<size_t>(shape.back());
  const size_t matrices = exponents_shape.size() > 1 ? static_cast<size_t>(shape.front()) : 1;
  const size_t size = table.size() / matrices;
  Vector<float> exponents(matrices * columns, 0), scaled(table.begin(), table.end());
  for (size_t c = 0; c < exponents.size(); ++c) {
    const size_t first = c / columns * size + c % columns;
    float largest = 0;
    for (size_t row = 0; row < size; row += columns)
      largest = std::max(largest, std::abs(table[first + row]));
    int exponent = 0;
    std::frexp(largest, &exponent);
    exponents[c] = static_cast<float>(exponent);
    for (size_t row = 0; row < size; row += columns)
      scaled[first + row] = std::ldexp(scaled[first + row], -exponent);
  }
  packer->Add(name, shape, scaled, -kTransformBits);
  packer->Add(exponents_name, exponents_shape, exponents, kExact);
}

Status CheckTable(const char* name, const Vector<float>& table, int64_t expected) {
  if (static_cast<int64_t>(table.size()) != expected) {
    return Error(StatusCode::kInvalidArgument, "tables.%s: it has %zu numbers; expected %lld", name,
                 table.size(), static_cast<long long>(expected));
  }
  const auto bad =
      std::find_if(table.begin(), table.end(), [](float x) { return !std::isfinite(x); });
  if (bad == table.end()) return {};
  return Error(StatusCode::kInternal, "tables.%s: element %td is not a finite number", name,
               bad - table.begin());
}

Status CheckNumbers(const RigTables& tables, const LocalGroupFactors& local) {
  Status status;
  VisitRigTables(tables,
                 [&](const char* name, const Vector<float>& table, const Vector<int64_t>& shape) {
                   const int64_t count = NumElements(shape);
                   const bool may_be_absent = FirstVersionOfTable(name) > kOldestRigFormatVersion;
                   if (status.ok() && !(table.empty() && may_be_absent))
                     status = CheckTable(name, table, count);
                 });
  if (!status.ok() || local.factors.empty()) return status;
  const Result<int64_t> count = NumLocalFactors(tables, local.group_handles);
  if (!count.ok()) return Status(StatusCode::kInvalidArgument, count.status().message());
  return CheckTable(kGroupFactorsTable, local.factors, *count);
}

}  // namespace

Result<Vector<PackedTable>> PackRigTables(const RigTables& tables, const LocalGroupFactors& local) {
  LIMBER_RETURN_IF_ERROR(CheckNumbers(tables, local));
  Packer packer;
  const int energy_bits = EnergyBits(tables);
  const bool has_local = !local.factors.empty();
  VisitRigTables(
      tables, [&](const char* name, const Vector<float>& table, const Vector<int64_t>& shape) {
        if (has_local && FollowsFromLocal(name)) return;
        if (name == std::string_view("residualFactor")) {
          AddResidual(tables, name, shape, energy_bits, &packer);
        } else if (name == std::string_view("modeTransforms")) {
          AddTransforms(table, name, shape, kModeExponentsTable, {shape.back()}, &packer);
        } else if (name == std::string_view("singleModeTransforms")) {
          AddTransforms(table, name, shape, kSingleModeExponentsTable,
                        {shape.front(), shape.back()}, &packer);
        } else {
          packer.Add(name, shape, table,
                     PackingExponent(table, IsEnergy(name) ? energy_bits : kTransformBits));
        }
      });
  if (has_local) {
    packer.Add(kGroupHandlesTable, {tables.num_groups, tables.num_handles()}, local.group_handles,
               kExact);
    packer.Add(kGroupFactorsTable, {static_cast<int64_t>(local.factors.size())}, local.factors,
               PackingExponent(local.factors, energy_bits));
  }
  return packer.Take();
}

uint64_t NumBytes(const Vector<PackedTable>& tables) {
  uint64_t sum = 0;
  for (const PackedTable& table : tables)
    sum += table.bytes.size();
  return sum;
}

}  // namespace limber::bake
