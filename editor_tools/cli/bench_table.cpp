#include "cli/bench_table.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <fstream>

namespace limber::cli {
namespace {

using Json = nlohmann::ordered_json;

template <class... Numbers>
std::string Format(const char* format, Numbers... numbers) {
  char text[64];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

// Three digits or so, as the paper prints them.
std::string Seconds(double seconds) {
  if (seconds < 1) return Format("%.2f", seconds);
  return Format(seconds < 10 ? "%.1f" : "%.0f", seconds);
}

// "6.1 us", "444 us", "25.1 ms".
std::string Duration(double seconds) {
  const double us = seconds * 1e6;
  if (us < 1e3) return Format(us < 99.95 ? "%.1f us" : "%.0f us", us);
  return Format(us < 99.95e3 ? "%.1f ms" : "%.0f ms", us / 1e3);
}

std::string Microseconds(double seconds) {
  return Format(seconds < 99.95e-6 ? "%.1f" : "%.0f", seconds * 1e6);
}

std::string StageColumns(const StageTimes& stages) {
  std::string text;
  for (double seconds : {stages.rotations, stages.nearness, stages.blend, stages.transforms}) {
    const std::string column = Microseconds(seconds);
    text += std::string(column.size() < 6 ? 6 - column.size() : 1, ' ') + column;
  }
  return text;
}

Json SizesJson(const BenchRow& row) {
  const RigTables& tables = row.rig->tables();
  return {{"name", row.name},
          {"dimension", tables.dimension},
          {"vertices", row.rig->mesh().num_solve_vertices},
          {"shapes", tables.num_shapes()},
          {"handles", tables.num_handles()},
          {"groups", tables.num_groups},
          {"modes", tables.num_modes},
          {"rotations", tables.has_rotations}};
}

}  // namespace

void PrintBenchHeading(bool with_paper, const Console& console) {
  if (!with_paper) {
    console.Print("%-28s %42s           of it, us", "", "");
    console.Print("%-28s k     |P|  |S|  |H|    |G|  alternation    rot.  near blend  skin",
                  "name");
    return;
  }
  console.Print("paper: Wampler 2016, table 1, a 2.4 GHz Xeon E5-2630. here: %s",
                ProcessorName().c_str());
  console.Print("%-11s %20s   precompute s     an alternation           of it, us", "", "");
  console.Print(
      "name         k    |P| |S| |H|   paper   here   paper     here  faster   rot.  near blend  "
      "skin  mesh");
}

void PrintBenchRow(const BenchRow& row, const Console& console) {
  const RigTables& tables = row.rig->tables();
  const std::string here = Duration(row.times.median), stages = StageColumns(row.times.stages);
  const unsigned vertices = row.rig->mesh().num_solve_vertices;
  if (row.paper == nullptr) {
    console.Print("%-28s %d %7u %4d %4d %6d %12s  %s", row.name.c_str(), tables.dimension, vertices,
                  tables.num_shapes(), tables.num_handles(), tables.num_groups, here.c_str(),
                  stages.c_str());
    return;
  }
  const std::string faster = Format("%.0fx", row.paper->alternation / row.times.median);
  console.Print("%-11s  %d %6u %3d %3d  %6s %6s  %6s %8s %7s %s  %s", row.name.c_str(),
                tables.dimension, vertices, tables.num_shapes(), tables.num_handles(),
                Seconds(row.paper->precompute).c_str(),
                row.precompute ? Seconds(*row.precompute).c_str() : "-",
                Format("%.0f ms", row.paper->alternation * 1e3).c_str(), here.c_str(),
                faster.c_str(), stages.c_str(), row.is_the_papers_mesh ? "paper" : "made");
}

Json BenchRowJson(const BenchRow& row) {
  Json json = SizesJson(row);
  if (row.paper != nullptr) {
    json["mesh"] = row.is_the_papers_mesh ? "paper" : "made";
    json["precompute_s"] = row.precompute ? Json(*row.precompute) : Json();
  }
  const StageTimes& stages = row.times.stages;
  json["alternation_us"] = row.times.median * 1e6;
  json["mean_us"] = row.times.mean * 1e6;
  json["stages_us"] = {{"rotations", stages.rotations * 1e6},
                       {"nearness", stages.nearness * 1e6},
                       {"blend", stages.blend * 1e6},
                       {"transforms", stages.transforms * 1e6}};
  if (row.paper != nullptr) {
    json["paper"] = {{"vertices", row.paper->vertices},
                     {"precompute_s", row.paper->precompute},
                     {"alternation_us", row.paper->alternation * 1e6}};
    json["times_faster"] = row.paper->alternation / row.times.median;
  }
  return json;
}

std::string ProcessorName() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "this machine";
}

}  // namespace limber::cli
