#include "host/app/render_report.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "host/base/build_info.hpp"
#include "host/base/numbers.hpp"
#include "host/scene/features.hpp"

namespace hemiray::app {
namespace {

// Stages whose items are rays, hence have a rate in rays per second.
bool traces_rays(const std::string& stage) {
  return stage == "path_intersect_closest" || stage == "path_intersect_shadow";
}

double rays_per_second(const StageTime& stage) {
  return stage.milliseconds > 0.0 ? static_cast<double>(stage.items) / (stage.milliseconds * 1e-3) : 0.0;
}

double total_rays(const RenderStatistics& s) { return static_cast<double>(s.rays.closest + s.rays.shadow); }

double compile_ms(const RenderStatistics& s) {
  double sum = s.launch_compile_ms;
  for (const ProgramStatistics& program : s.programs) sum += program.build_ms;
  return sum;
}

double rays_of(const DeviceStatistics& d) { return static_cast<double>(d.rays.closest + d.rays.shadow); }

double share_of(const DeviceStatistics& device, const RenderStatistics& s) {
  double all = 0.0;
  for (const DeviceStatistics& d : s.devices) all += static_cast<double>(d.samples);
  return all > 0.0 ? static_cast<double>(device.samples) / all : 0.0;
}

// Per millisecond of work; 0 where there was none.
double rays_per_ms(const DeviceStatistics& d) { return d.busy_ms > 0.0 ? rays_of(d) / d.busy_ms : 0.0; }

nlohmann::json devices_json(const RenderStatistics& s) {
  nlohmann::json devices = nlohmann::json::array();
  for (const DeviceStatistics& d : s.devices) {
    devices.push_back({{"index", d.index},
                       {"name", d.name},
                       {"platform", d.platform},
                       {"driver", d.driver},
                       {"tiles", d.tiles},
                       {"samples", d.samples},
                       {"share", share_of(d, s)},
                       {"rays", {{"closest", d.rays.closest}, {"shadow", d.rays.shadow}}},
                       {"busy_ms", d.busy_ms},
                       {"mrays_per_s", rays_per_ms(d) * 1e-3},
                       {"predicted_bytes", d.predicted_bytes},
                       {"peak_bytes", d.peak_bytes},
                       {"failed", !d.failure.empty()},
                       {"failure", d.failure}});
  }
  return devices;
}

// Nothing was compiled: every program came from our cache or, where the driver keeps one, from the driver's.
bool all_cached(const RenderStatistics& s) {
  return s.kernels_compiled == 0 &&
         std::all_of(s.programs.begin(), s.programs.end(), [](const auto& p) { return p.cached; });
}

}  // namespace

std::string report_table(const RenderFacts& f, const RenderStatistics& s) {
  std::string text;
  const auto line = [&text](const std::string& name, const std::string& value) {
    text += fmt::format("{:<10}{}\n", name, value);
  };
  const std::string instances = s.accel.instances > 0 ? ", " + format_count(s.accel.instances, "instance") : "";
  line("scene", fmt::format("{}: {}{}, {}, {}, {}", f.scene, format_count(s.accel.primitives, "primitive"), instances,
                            format_count(s.planes, "plane"), format_count(s.lights, "light"),
                            format_count(s.emitters, "emitter")));
  line("effects", fmt::format("{}", fmt::join(feature_names(s.features), " ")));
  if (s.devices.size() == 1) {
    line("device", fmt::format("{} ({}), peak memory {}", f.device, f.platform, format_bytes(s.peak_device_bytes)));
  } else {
    for (const DeviceStatistics& d : s.devices) {
      line("device", fmt::format("{} ({}), peak memory {}", d.name, d.platform, format_bytes(d.peak_bytes)));
      const std::string rate = format_rate(rays_per_ms(d) * 1e3, "rays/s");
      line("", fmt::format("  {}, {:.1f} % of the samples, {}{}", format_count(d.tiles, "tile"), share_of(d, s) * 100.0,
                           rate, d.failure.empty() ? "" : ", FAILED"));
    }
  }
  line("picture",
       fmt::format("{} x {}, {} of {} samples, depth {}, {}{}", f.width, f.height, s.passes, f.spp, f.depth, f.engine,
                   std::string(f.strict ? ", strict" : "") + (f.precision == "double" ? ", double precision" : "")));
  if (has_feature(s.features, HR_FEATURE_SMOOTH_NORMALS) && has_feature(s.features, HR_FEATURE_LIGHTS)) {
    line("shadows",
         f.terminator == "smooth" ? "start on the smooth surface (shadow terminator)" : "start on triangles");
  }
  line("compile", fmt::format("{} ({})", format_duration(compile_ms(s) * 1e-3), all_cached(s) ? "cached" : "cold"));
  line("build",
       fmt::format("{}, {}, {}, {}-bit Morton codes", format_duration(s.accel.build_ms * 1e-3),
                   format_count(s.accel.nodes, "node"), format_count(s.accel.blocks, "block"), s.accel.morton_bits));
  if (s.accel.non_finite + s.accel.degenerate > 0) {
    line("dropped", fmt::format("{} not finite, {} without area", format_count(s.accel.non_finite, "primitive"),
                                s.accel.degenerate));
  }
  line("trace",
       fmt::format("{}, {} rays, {}", format_duration(s.trace_ms * 1e-3), format_count(s.rays.closest + s.rays.shadow),
                   format_rate(total_rays(s) / (s.trace_ms * 1e-3), "rays/s")));
  if (has_feature(s.features, HR_FEATURE_IMPLICITS)) {
    line("uncertain", fmt::format("{} roots of implicit surfaces, taken as misses", format_count(s.uncertain_roots)));
  }
  line("first", fmt::format("{:.2f} s to the first picture, {:.2f} s in all", f.first_pixel_s, f.total_s));
  text += fmt::format("{:<26}{:>9}{:>12}{:>12}{:>12}\n", "kernel", "launches", "items", "ms", "Mrays/s");
  for (const StageTime& stage : s.stages) {
    text += fmt::format("{:<26}{:>9}{:>12}{:>12.2f}", stage.name, stage.launches, format_count(stage.items),
                        stage.milliseconds);
    text += traces_rays(stage.name) ? fmt::format("{:>12.2f}\n", rays_per_second(stage) * 1e-6) : "\n";
  }
  return text;
}

std::string report_json(const RenderFacts& f, const RenderStatistics& s) {
  nlohmann::json programs = nlohmann::json::array();
  for (const ProgramStatistics& p : s.programs) {
    programs.push_back({{"name", p.name}, {"kernels", p.kernels}, {"ms", p.build_ms}, {"cached", p.cached}});
  }
  nlohmann::json stages = nlohmann::json::array();
  for (const StageTime& stage : s.stages) {
    nlohmann::json row = {
        {"name", stage.name}, {"launches", stage.launches}, {"items", stage.items}, {"ms", stage.milliseconds}};
    if (traces_rays(stage.name)) row["mrays_per_s"] = rays_per_second(stage) * 1e-6;
    stages.push_back(std::move(row));
  }
  nlohmann::json all = {{"hemiray", {{"version", kVersion}, {"commit", kCommit}}},
                        {"scene",
                         {{"file", f.scene},
                          {"primitives", s.accel.primitives},
                          {"instances", s.accel.instances},
                          {"dropped_non_finite", s.accel.non_finite},
                          {"dropped_degenerate", s.accel.degenerate},
                          {"planes", s.planes},
                          {"lights", s.lights},
                          {"emitters", s.emitters},
                          {"notes", f.notes}}},
                        {"output", f.output},
                        {"device", {{"name", f.device}, {"platform", f.platform}, {"driver", f.driver}}},
                        {"devices", devices_json(s)},
                        {"options",
                         {{"engine", f.engine},
                          {"width", f.width},
                          {"height", f.height},
                          {"spp", f.spp},
                          {"depth", f.depth},
                          {"seed", f.seed},
                          {"strict", f.strict},
                          {"precision", f.precision},
                          {"terminator", f.terminator}}},
                        {"effects", feature_names(s.features)},
                        {"uncertain_roots", s.uncertain_roots},
                        {"passes", s.passes},
                        {"interrupted", s.interrupted},
                        {"load_ms", f.load_ms},
                        {"upload_ms", s.upload_ms},
                        {"build_ms", s.accel.build_ms},
                        {"morton_bits", s.accel.morton_bits},
                        {"nodes", s.accel.nodes},
                        {"blocks", s.accel.blocks},
                        {"compile_ms", compile_ms(s)},
                        {"compile_cached", all_cached(s)},
                        {"kernels_compiled", s.kernels_compiled},
                        {"programs", programs},
                        {"trace_ms", s.trace_ms},
                        {"rays", {{"closest", s.rays.closest}, {"shadow", s.rays.shadow}}},
                        {"mrays_per_s", total_rays(s) / (s.trace_ms * 1e3)},
                        {"predicted_device_bytes", s.predicted_device_bytes},
                        {"peak_device_bytes", s.peak_device_bytes},
                        {"first_pixel_s", f.first_pixel_s},
                        {"total_s", f.total_s},
                        {"stages", stages}};
  if (!f.radiosity.empty()) all["radiosity"] = nlohmann::json::parse(f.radiosity);
  return all.dump(2) + "\n";
}

std::string report_trace(const std::vector<DeviceStatistics>& devices) {
  nlohmann::json events = nlohmann::json::array();
  int process = 0;
  for (const DeviceStatistics& device : devices) {
    process++;
    for (const TraceSpan& span : device.spans) {
      events.push_back({{"name", span.name},
                        {"cat", span.category},
                        {"ph", "X"},
                        {"pid", process},
                        {"tid", span.category == "kernel" ? 2 : 1},
                        {"ts", span.start_us},
                        {"dur", span.duration_us}});
    }
    const auto name = [&events, process](const char* what, int thread, const std::string& value) {
      events.push_back({{"name", what}, {"ph", "M"}, {"pid", process}, {"tid", thread}, {"args", {{"name", value}}}});
    };
    name("thread_name", 1, "host");
    name("thread_name", 2, "device");
    if (devices.size() > 1) name("process_name", 0, device.name);
  }
  return nlohmann::json{{"traceEvents", events}}.dump() + "\n";
}

std::map<std::string, std::string> report_metadata(const RenderFacts& f, const RenderStatistics& s) {
  return {{"version", kVersion},
          {"commit", kCommit},
          {"scene", f.scene},
          {"device", fmt::format("{} ({})", f.device, f.platform)},
          {"driver", f.driver},
          {"options", f.options},
          {"engine", f.engine},
          {"samples", std::to_string(s.passes)},
          {"depth", std::to_string(f.depth)},
          {"seed", std::to_string(f.seed)},
          {"strict", f.strict ? "true" : "false"},
          {"precision", f.precision},
          {"terminator", f.terminator},
          {"effects", fmt::format("{}", fmt::join(feature_names(s.features), " "))},
          {"build_ms", fmt::format("{:.3f}", s.accel.build_ms)},
          {"trace_ms", fmt::format("{:.3f}", s.trace_ms)}};
}

}  // namespace hemiray::app
