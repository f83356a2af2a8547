// What `limber bench` found out about a character, as a line of a table and as JSON.
#pragma once

#include "bench/drag_path.h"
#include "bench/paper_table.h"
#include "cli/console.h"
#include "rig/rig.h"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>

namespace limber::cli {

struct BenchRow {
  std::string name;
  const bench::PaperRow* paper = nullptr;  // null: a baked file, in no table of the paper
  bool is_the_papers_mesh = false;
  std::shared_ptr<const Rig> rig;
  std::optional<double> precompute;  // seconds of the bake; none where it was not one to measure
  bench::AlternationTimes times;
};

// The heading of the rows to come: with the paper's columns or without.
void PrintBenchHeading(bool with_paper, const Console& console);
void PrintBenchRow(const BenchRow& row, const Console& console);
nlohmann::ordered_json BenchRowJson(const BenchRow& row);

// What the processor calls itself; "this machine" where it does not say.
std::string ProcessorName();

}  // namespace limber::cli
