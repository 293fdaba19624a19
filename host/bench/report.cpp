#include "host/bench/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "host/base/numbers.hpp"

namespace hemiray::bench {
namespace {

using nlohmann::ordered_json;

// A tree in words; what does not apply to it is left out.
std::string describe(const TreeFacts& f) {
  std::string text = f.sah_cost > 0 ? fmt::format("SAH {:.1f}, ", f.sah_cost) : "";
  text += fmt::format("depth {}, {}", f.depth, format_count(f.nodes, "node"));
  if (f.node_fill > 0) text += fmt::format(" {:.0f} % full", 100.0 * f.node_fill);
  text += fmt::format(", {} {:.0f} % full", format_count(f.blocks, "block"), 100.0 * f.block_fill);
  if (f.references > 1) text += fmt::format(", {:.1f} references a triangle", f.references);
  return text + ", " + format_bytes(f.bytes);
}

ordered_json to_json(const Spread& spread) {
  return {{"median", spread.median}, {"least", spread.least}, {"most", spread.most}, {"runs", spread.runs}};
}

ordered_json to_json(const SceneResults& scene) {
  ordered_json builds = ordered_json::array(), traces = ordered_json::array();
  for (const BuildTimes& build : scene.builds) {
    ordered_json stages = ordered_json::array();
    for (const StageTime& stage : build.stages) {
      stages.push_back({{"name", stage.name}, {"ms", stage.milliseconds}, {"launches", stage.launches}});
    }
    ordered_json facts = nullptr;
    if (build.facts) {
      facts = {{"sah_cost", build.facts->sah_cost},     {"depth", build.facts->depth},
               {"node_fill", build.facts->node_fill},   {"block_fill", build.facts->block_fill},
               {"references", build.facts->references}, {"nodes", build.facts->nodes},
               {"blocks", build.facts->blocks},         {"bytes", build.facts->bytes}};
    }
    ordered_json memory = nullptr;
    if (build.memory) {
      memory = {{"peak_bytes", build.memory->peak},
                {"predicted_bytes", build.memory->predicted},
                {"node_buffers", build.memory->node_buffers},
                {"block_buffers", build.memory->block_buffers}};
    }
    builds.push_back(
        {{"tree", build.tree}, {"ms", to_json(build.ms)}, {"stages", stages}, {"facts", facts}, {"memory", memory}});
  }
  for (const TraceTimes& trace : scene.traces) {
    traces.push_back({{"tracer", trace.tracer},
                      {"rays", trace.rays},
                      {"ray_count", trace.ray_count},
                      {"ms", to_json(trace.ms)},
                      {"mrays_per_s", mrays_per_second(trace)},
                      {"disagreements", trace.disagreements},
                      {"valid", trace.valid}});
    if (trace.visits) {
      traces.back()["nodes_per_ray"] = trace.visits->nodes;
      traces.back()["blocks_per_ray"] = trace.visits->blocks;
    }
  }
  ordered_json wanted = nullptr;
  if (scene.wanted_triangles > 0) wanted = scene.wanted_triangles;
  return {{"scene", scene.scene},
          {"wanted_triangles", wanted},
          {"triangles", scene.triangles},
          {"builds", builds},
          {"traces", traces}};
}

ordered_json to_json(const Machine& m) {
  ordered_json peer = nullptr;
  if (!m.peer.empty()) peer = m.peer;
  return {{"device", m.device},
          {"platform", m.platform},
          {"driver", m.driver},
          {"processor", m.processor},
          {"processor_class", m.processor_class},
          {"threads", m.threads},
          {"version", m.version},
          {"commit", m.commit},
          {"peer", peer},
          {"rounds", m.rounds}};
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

}  // namespace

std::string machine_table(const Machine& m) {
  return fmt::format("device     {} ({}), driver {}\nprocessor  {}{}, {} threads\nhemiray    {} ({}){}{}\n", m.device,
                     m.platform, m.driver, m.processor, m.processor_class.empty() ? "" : " (" + m.processor_class + ")",
                     m.threads, m.version, m.commit, m.peer.empty() ? "" : ", beside " + m.peer,
                     fmt::format(", medians of up to {} interleaved rounds", m.rounds));
}

std::string builds_table(const SceneResults& scene) {
  std::string text =
      fmt::format("\n{}, {}\n{:<40}{:>10}{:>10}{:>10}  {}\n", scene.scene, format_count(scene.triangles, "triangle"),
                  "build [ms]", "median", "least", "most", "tree");
  for (const BuildTimes& build : scene.builds) {
    text +=
        fmt::format("  {:<38}{:>10.2f}{:>10.2f}{:>10.2f}", build.tree, build.ms.median, build.ms.least, build.ms.most);
    if (build.facts) {
      text += "  " + describe(*build.facts);
    }
    text += '\n';
    if (build.memory) {
      const BuildMemory& memory = *build.memory;
      text += fmt::format("    peak device memory {}, {} predicted", format_bytes(memory.peak),
                          format_bytes(memory.predicted));
      const bool in_chunks = memory.node_buffers > 1 || memory.block_buffers > 1;
      if (in_chunks)
        text += fmt::format("; nodes in {}, blocks in {} buffers", memory.node_buffers, memory.block_buffers);
      text += '\n';
    }
    for (const StageTime& stage : build.stages) {
      text += fmt::format("    {:<36}{:>10.2f}  in {} launches\n", stage.name, stage.milliseconds, stage.launches);
    }
  }
  return text;
}

std::string traces_table(const std::vector<TraceTimes>& traces) {
  std::string text;
  for (const TraceTimes& trace : traces) {
    if (text.empty()) {
      text = fmt::format("{:<40}{:>10}{:>10}{:>10}{:>8}  {}\n", fmt::format("{} [Mrays/s]", trace.rays), "median",
                         "least", "most", "ratio", "answers");
    }
    const auto of = [&](double ms) { return static_cast<double>(trace.ray_count) / (ms * 1e3); };
    const bool alone = traces.size() == 1 && trace.disagreements == 0 && !trace.valid;
    const std::string answers = alone ? "NOT VERIFIED: no other tracer"
                                      : fmt::format("{}{} differ", trace.valid ? "" : "INVALID: ", trace.disagreements);
    text += fmt::format("  {:<38}{:>10.2f}{:>10.2f}{:>10.2f}{:>8.2f}  {}", trace.tracer, of(trace.ms.median),
                        of(trace.ms.most), of(trace.ms.least),
                        mrays_per_second(trace) / mrays_per_second(traces.front()), answers);
    if (trace.visits) {
      text += fmt::format(", {:.2f} nodes + {:.2f} blocks a ray", trace.visits->nodes, trace.visits->blocks);
    }
    text += '\n';
  }
  return text;
}

std::string leaks_table(const std::vector<LeakResult>& leaks) {
  std::string text = fmt::format("\n{:<22}{:<10}{:<36}{:>10}{:>13}{:>10}\n", "leaks out of", "through", "tracer",
                                 "rays", "closest hit", "any hit");
  for (const LeakResult& leak : leaks) {
    text += fmt::format("  {:<20}{:<10}{:<36}{:>10}{:>13}{:>10}\n", leak.mesh, leak.target, leak.tracer, leak.rays,
                        leak.closest_hit_leaks, leak.any_hit_leaks);
  }
  return text;
}

std::string engines_table(const std::vector<EngineTimes>& engines) {
  std::string text =
      fmt::format("\n{:<36}{:>10}{:>10}{:>10}{:>12}\n", "engines [ms]", "median", "least", "most", "Mrays/s");
  for (const EngineTimes& e : engines) {
    text += fmt::format("  {:<34}{:>10.2f}{:>10.2f}{:>10.2f}{:>12.2f}{}\n", fmt::format("{} {}", e.scene, e.engine),
                        e.ms.median, e.ms.least, e.ms.most, static_cast<double>(e.rays) / (e.ms.median * 1e3),
                        e.valid ? "" : "  INVALID: the pictures differ");
  }
  return text;
}

std::string bars_table(const Machine& machine, const std::vector<BarResult>& bars) {
  std::string text =
      fmt::format("\nbars for {} ({}), {} threads\n", machine.processor, machine.processor_class, machine.threads);
  for (const BarResult& bar : bars) {
    std::string what = bar.label;
    if (bar.triangles > 0) what += ", " + format_count(bar.triangles, "triangle");
    std::string measured = "-";
    if (bar.verdict != Verdict::not_measured) {
      measured = bar.kind == BarKind::leaks ? fmt::format("{:.0f}", bar.measured) : fmt::format("{:.2f}", bar.measured);
    }
    text += fmt::format("{:<12} {:<62} {:>7}, bar {} {:g}{}\n", to_string(bar.verdict), what, measured,
                        bar.higher_is_better ? "at least" : "at most", bar.bar,
                        bar.best_peer.empty() ? "" : fmt::format(" ({})", bar.best_peer));
  }
  return text;
}

std::string report_json(const Report& report) {
  ordered_json json{{"hemiray_bench", 1},
                    {"machine", to_json(report.machine)},
                    {"notes", report.notes},
                    {"interrupted", report.interrupted}};
  for (const char* part : {"scenes", "engines", "leaks", "bars"}) json[part] = ordered_json::array();
  for (const SceneResults& scene : report.scenes) json["scenes"].push_back(to_json(scene));
  for (const EngineTimes& e : report.engines) {
    json["engines"].push_back(
        {{"scene", e.scene}, {"engine", e.engine}, {"rays", e.rays}, {"ms", to_json(e.ms)}, {"valid", e.valid}});
  }
  for (const LeakResult& leak : report.leaks) {
    json["leaks"].push_back({{"mesh", leak.mesh},
                             {"target", leak.target},
                             {"tracer", leak.tracer},
                             {"rays", leak.rays},
                             {"closest_hit_leaks", leak.closest_hit_leaks},
                             {"any_hit_leaks", leak.any_hit_leaks}});
  }
  for (const BarResult& bar : report.bars) {
    ordered_json measured = nullptr;
    if (bar.verdict != Verdict::not_measured) measured = bar.measured;
    json["bars"].push_back({{"label", bar.label},
                            {"triangles", bar.triangles},
                            {"measured", measured},
                            {"bar", bar.bar},
                            {"better", bar.higher_is_better ? "higher" : "lower"},
                            {"against", bar.best_peer},
                            {"verdict", to_string(bar.verdict)}});
  }
  // File names need not be UTF-8, JSON must be.
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + '\n';
}

std::string report_csv(const Report& report) {
  std::string text = "kind,scene,triangles,rays,tracer,ray_count,median_ms,least_ms,most_ms,disagreements,valid\n";
  for (const SceneResults& scene : report.scenes) {
    const std::string name = csv_field(scene.scene);
    for (const BuildTimes& b : scene.builds) {
      text += fmt::format("build,{},{},,{},,{},{},{},,\n", name, scene.triangles, b.tree, b.ms.median, b.ms.least,
                          b.ms.most);
    }
    for (const TraceTimes& t : scene.traces) {
      text += fmt::format("trace,{},{},{},{},{},{},{},{},{},{}\n", name, scene.triangles, t.rays, t.tracer, t.ray_count,
                          t.ms.median, t.ms.least, t.ms.most, t.disagreements, t.valid ? 1 : 0);
    }
  }
  for (const EngineTimes& e : report.engines) {
    text += fmt::format("engine,{},,,{},{},{},{},{},,{}\n", csv_field(e.scene), e.engine, e.rays, e.ms.median,
                        e.ms.least, e.ms.most, e.valid ? 1 : 0);
  }
  for (const LeakResult& l : report.leaks) {
    text += fmt::format("leak,{},,{},{},{},,,,{},{}\n", csv_field(l.mesh), l.target, l.tracer, l.rays,
                        l.closest_hit_leaks + l.any_hit_leaks, l.closest_hit_leaks + l.any_hit_leaks == 0 ? 1 : 0);
  }
  return text;
}

}  // namespace hemiray::bench
