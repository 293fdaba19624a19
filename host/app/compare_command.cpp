// hemiray compare A.exr B.exr: numbers, a difference image, and a verdict for a team's own CI.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "host/app/commands.hpp"
#include "host/base/atomic_file.hpp"
#include "host/base/compare.hpp"
#include "host/base/error.hpp"
#include "host/base/exr.hpp"
#include "host/base/png.hpp"

namespace hemiray::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter =
    R"(Exit code: 0 within the tolerances (or none given), 3 beyond one of them, 2 where the images cannot be compared.
The limits hold for the beauty layer (or --layer); `identical` for the bits of every layer (or of --layer alone).

Examples:
  hemiray compare new.exr reference.exr
  hemiray compare new.exr reference.exr --tolerance relmse=1e-3,max=0.5
  hemiray compare a.exr b.exr --tolerance identical --no-difference
  hemiray compare a.exr b.exr --layer depth --difference depth_difference.exr --json)";

struct CompareOptions {
  std::string a;
  std::string b;
  std::vector<std::string> tolerances;
  std::string difference;
  bool no_difference = false;
  std::string layer;
  bool json = false;
};

/// One bound the user asked for, and whether it holds.
struct Verdict {
  std::string tolerance;  // as the user wrote it
  bool within = false;
};

/// Where the difference image went and how it is to be read.
struct DifferenceFile {
  fs::path path;
  std::string layer;       // the one a PNG shows
  int exposure_stops = 0;  // a PNG shows |A - B| times 2^this
};

double parse_limit(const std::string& text, std::string_view number) {
  double limit = 0;
  const char* end = number.data() + number.size();
  const auto [stop, error] = std::from_chars(number.data(), end, limit);
  if (error != std::errc() || stop != end || !std::isfinite(limit)) {
    throw InputError("--tolerance " + text, "\"" + std::string(number) + "\" is not a number; write, say, relmse=1e-3");
  }
  if (limit < 0) throw InputError("--tolerance " + text, "a limit cannot be negative");
  return limit;
}

Verdict judge(const std::string& text, const ImageComparison& comparison, bool one_layer) {
  const LayerComparison& headline = comparison.layers[comparison.headline];
  if (text == "identical") return {text, one_layer ? headline.identical : comparison.identical};
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  if (equals != std::string::npos) {
    const double limit = parse_limit(text, std::string_view(text).substr(equals + 1));
    if (name == "relmse") return {text, headline.rel_mse <= limit};
    if (name == "rmse") return {text, headline.rmse <= limit};
    if (name == "max") return {text, headline.max_abs <= limit};
    if (name == "psnr") return {text, headline.psnr_db >= limit};
  }
  throw InputError("--tolerance " + text,
                   "unknown tolerance; use relmse=X, rmse=X, max=X, psnr=X (decibels, at least) or identical");
}

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

void check_difference_option(const CompareOptions& options) {
  const std::string extension = lower_extension(options.difference);
  if (extension != ".exr" && extension != ".png") {
    throw InputError("--difference " + options.difference, "the file name must end in .exr or .png");
  }
  for (const std::string& input : {options.a, options.b}) {
    std::error_code ignored;
    if (fs::equivalent(options.difference, input, ignored)) {
      throw InputError("--difference " + options.difference,
                       "would overwrite an image that is compared; name another file");
    }
  }
  check_writable(options.difference);
}

// Brightened by whole stops so that the largest difference of the layer is in [0.5, 1).
int visible_exposure(double max_abs) {
  int exponent = 0;
  std::frexp(max_abs, &exponent);
  return -exponent;
}

DifferenceFile write_difference(const fs::path& path, const Image& difference, const ImageComparison& comparison) {
  const LayerComparison& headline = comparison.layers[comparison.headline];
  DifferenceFile file{path, headline.layer, 0};
  if (lower_extension(path) == ".exr") {
    write_exr(path, difference);
    return file;
  }
  // Black says nothing where only another layer differs.
  double max_abs = headline.max_abs;
  if (headline.identical && comparison.first) {
    file.layer = comparison.first->layer;
    for (const LayerComparison& layer : comparison.layers) {
      if (layer.layer == file.layer) max_abs = layer.max_abs;
    }
  }
  if (max_abs > 0) file.exposure_stops = visible_exposure(max_abs);
  write_png(path, difference, file.layer, file.exposure_stops);
  return file;
}

std::string display_name(const std::string& layer) { return layer.empty() ? "beauty" : layer; }

void print_table(const ImageComparison& comparison) {
  std::size_t name_width = 8;
  for (const LayerComparison& layer : comparison.layers) {
    name_width = std::max(name_width, display_name(layer.layer).size());
  }
  fmt::print("{:<{}}  {:>12}  {:>12}  {:>10}  {:>12}\n", "layer", name_width + 2, "RMSE", "relMSE", "PSNR [dB]",
             "maximum");
  for (std::size_t i = 0; i < comparison.layers.size(); ++i) {
    const LayerComparison& layer = comparison.layers[i];
    fmt::print("{:<{}}  {:>12.6g}  {:>12.6g}  {:>10.2f}  {:>12.6g}\n",
               (i == comparison.headline ? "* " : "  ") + display_name(layer.layer), name_width + 2, layer.rmse,
               layer.rel_mse, layer.psnr_db, layer.max_abs);
  }
}

void print_text(const ImageComparison& comparison, const std::vector<Verdict>& verdicts,
                const std::optional<DifferenceFile>& difference) {
  print_table(comparison);
  if (comparison.identical) {
    fmt::print("identical: every bit of every layer\n");
  } else {
    const PixelDifference& first = *comparison.first;
    fmt::print("first difference: pixel ({}, {}), layer {}, channel {}: {} against {}\n", first.x, first.y,
               display_name(first.layer), first.channel, first.a, first.b);
  }
  if (difference) {
    fmt::print("difference image: {}", difference->path.string());
    if (lower_extension(difference->path) == ".png") {
      fmt::print(" (layer {}, |A - B| x 2^{})", display_name(difference->layer), difference->exposure_stops);
    }
    fmt::print("\n");
  }
  for (const Verdict& verdict : verdicts) {
    fmt::print("tolerance {}: {}\n", verdict.tolerance, verdict.within ? "within" : "BEYOND");
  }
}

nlohmann::ordered_json first_json(const std::optional<PixelDifference>& first) {
  if (!first) return nullptr;
  return {{"x", first->x}, {"y", first->y}, {"layer", first->layer}, {"channel", first->channel},
          {"a", first->a}, {"b", first->b}};
}

void print_json(const CompareOptions& options, const ImageComparison& comparison, const std::vector<Verdict>& verdicts,
                const std::optional<DifferenceFile>& difference, bool within) {
  nlohmann::ordered_json json{{"a", options.a}, {"b", options.b}};
  json["headline_layer"] = comparison.layers[comparison.headline].layer;
  json["identical"] = comparison.identical;
  json["first_difference"] = first_json(comparison.first);
  json["layers"] = nlohmann::ordered_json::array();
  for (const LayerComparison& layer : comparison.layers) {
    nlohmann::ordered_json entry{{"layer", layer.layer}, {"rmse", layer.rmse}, {"rel_mse", layer.rel_mse}};
    entry["psnr_db"] = nullptr;  // JSON has no infinity
    if (std::isfinite(layer.psnr_db)) entry["psnr_db"] = layer.psnr_db;
    entry["max_abs"] = layer.max_abs;
    entry["identical"] = layer.identical;
    entry["first_difference"] = first_json(layer.first);
    json["layers"].push_back(entry);
  }
  json["difference_image"] = nullptr;
  if (difference) json["difference_image"] = difference->path.string();
  json["tolerances"] = nlohmann::ordered_json::array();
  for (const Verdict& verdict : verdicts) {
    json["tolerances"].push_back({{"tolerance", verdict.tolerance}, {"within", verdict.within}});
  }
  json["within"] = within;
  // File names need not be UTF-8, JSON must be.
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::optional<DifferenceFile> write_default_difference(const CompareOptions& options, const Image& difference,
                                                       const ImageComparison& comparison) {
  const fs::path path = fs::path(options.a).replace_extension(".diff.png");
  std::error_code error_code;
  if (fs::equivalent(path, options.a, error_code) || fs::equivalent(path, options.b, error_code)) {
    fmt::print(stderr, "warning: no difference image written: {} is one of the images compared\n", path.string());
    return std::nullopt;
  }
  try {
    return write_difference(path, difference, comparison);
  } catch (const Error& error) {
    // Nobody asked for this file by name: the verdict matters more.
    fmt::print(stderr, "warning: no difference image written: {}\n", error.what());
    return std::nullopt;
  }
}

int run_compare(const CompareOptions& options) {
  if (!options.difference.empty()) check_difference_option(options);
  const Image a = read_exr(options.a);
  const Image b = read_exr(options.b);
  const ImageComparison comparison = compare_images(a, b, options.a, options.b, options.layer);
  std::vector<Verdict> verdicts;
  for (const std::string& tolerance : options.tolerances) {
    verdicts.push_back(judge(tolerance, comparison, !options.layer.empty()));
  }

  std::optional<DifferenceFile> difference;
  if (!options.difference.empty()) {
    difference = write_difference(options.difference, difference_image(a, b, options.a, options.b), comparison);
  } else if (!options.no_difference && !comparison.identical) {
    difference = write_default_difference(options, difference_image(a, b, options.a, options.b), comparison);
  }

  const bool within = std::all_of(verdicts.begin(), verdicts.end(), [](const Verdict& v) { return v.within; });
  if (options.json) {
    print_json(options, comparison, verdicts, difference, within);
  } else {
    print_text(comparison, verdicts, difference);
  }
  return static_cast<int>(within ? ExitCode::ok : ExitCode::verdict);
}

}  // namespace

void add_compare_command(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App* command = app.add_subcommand("compare", "Measure how far image A is from the reference B");
  command->add_option("A", options->a, "The image, an EXR file")->required();
  command->add_option("B", options->b, "The reference, an EXR file of the same size and layers")->required();
  command
      ->add_option("--tolerance", options->tolerances,
                   "Make the exit code a verdict: relmse=X, rmse=X, max=X (at most), psnr=X (decibels, at least) or "
                   "identical; may be repeated or comma separated, all must hold")
      ->delimiter(',')
      ->allow_extra_args(false);
  auto* difference = command->add_option(
      "--difference", options->difference,
      "Write |A - B| to this .exr (all layers) or .png (one layer, brightened by whole stops until it shows). Without "
      "this option it goes to A's name with .diff.png, where the images differ");
  command->add_flag("--no-difference", options->no_difference, "Write no difference image")->excludes(difference);
  command->add_option("--layer", options->layer, "The layer that is judged and shown (default: beauty)");
  command->add_flag("--json", options->json, "Print JSON");
  command->footer(kFooter);
  command->callback([options, &exit_code] { exit_code = run_compare(*options); });
}

}  // namespace hemiray::app
