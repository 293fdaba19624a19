// What a render says about itself: a table for people, JSON for machines, a trace for chrome://tracing.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host/gpu/profiler.hpp"
#include "host/path/render.hpp"

namespace hemiray::app {

/// Everything the reports need beside the statistics.
struct RenderFacts {
  std::string scene;
  std::string output;
  std::string device;  ///< several: joined by " + "; so are the other two
  std::string platform;
  std::string driver;
  std::string options;  ///< the command line's, as given
  std::string engine;
  int width = 0, height = 0;
  std::uint32_t seed = 0;
  bool strict = false;
  std::string precision;   ///< single or double
  std::string terminator;  ///< smooth or hard; of no effect without smooth normals
  int spp = 0, depth = 0;
  double load_ms = 0.0;
  double first_pixel_s = 0.0;  ///< process start to the end of the first pass
  double total_s = 0.0;        ///< process start to the statistics
  std::vector<std::string> notes;
  std::string radiosity;  ///< JSON of the solution shown; empty: none
};

std::string report_table(const RenderFacts& facts, const RenderStatistics& statistics);
std::string report_json(const RenderFacts& facts, const RenderStatistics& statistics);
/// Chrome's trace event format; a process for each device.
std::string report_trace(const std::vector<DeviceStatistics>& devices);
/// What goes into the picture's header.
std::map<std::string, std::string> report_metadata(const RenderFacts& facts, const RenderStatistics& statistics);

}  // namespace hemiray::app
