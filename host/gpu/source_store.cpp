#include "host/gpu/source_store.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string_view>

#include "host/base/error.hpp"

namespace hemiray {
namespace {

// The path of an include directive, or empty.
std::string_view included_path(std::string_view line) {
  const std::size_t hash = line.find_first_not_of(" \t");
  if (hash == std::string_view::npos || line[hash] != '#') return {};
  const std::size_t word = line.find_first_not_of(" \t", hash + 1);
  if (word == std::string_view::npos || line.substr(word, 7) != "include") return {};
  const std::size_t open = line.find('"', word);
  const std::size_t close = open == std::string_view::npos ? open : line.find('"', open + 1);
  if (close == std::string_view::npos) return {};
  return line.substr(open + 1, close - open - 1);
}

class Flattener {
 public:
  void add(const std::string& path) {
    // Lists and templates (.def) may be read again, but not within themselves.
    if (!seen_.insert(path).second && !path.ends_with(".def")) return;
    if (!open_.insert(path).second) return;
    std::istringstream lines(kernel_source(path));
    text_ += "#line 1 \"" + path + "\"\n";
    std::string line;
    for (int number = 1; std::getline(lines, line); number++) {
      const std::string_view include = included_path(line);
      if (include.empty()) {
        text_ += line + "\n";
      } else {
        add(std::string(include));
        text_ += "#line " + std::to_string(number + 1) + " \"" + path + "\"\n";
      }
    }
    open_.erase(path);
  }
  std::string take() { return std::move(text_); }

 private:
  std::set<std::string> seen_;
  std::set<std::string> open_;
  std::string text_;
};

// "file:line" of each line of a flattened text, counted from 1; "" where no #line came before.
std::vector<std::string> places_of_lines(const std::string& flattened) {
  std::vector<std::string> places(1);
  std::istringstream lines(flattened);
  std::string line, file;
  std::size_t number = 0;
  while (std::getline(lines, line)) {
    places.push_back(file.empty() ? "" : file + ":" + std::to_string(number++));
    std::smatch directive;
    static const std::regex pattern("#line ([0-9]+) \"(.*)\"");
    if (line.rfind("#line ", 0) == 0 && std::regex_match(line, directive, pattern)) {
      number = std::stoul(directive[1]);
      file = directive[2];
    }
  }
  return places;
}

}  // namespace

std::string kernel_source(const std::string& path) {
  if (const char* folder = std::getenv("HEMIRAY_KERNEL_DIR")) {
    if (!std::filesystem::is_directory(folder))
      throw InputError("HEMIRAY_KERNEL_DIR", std::string(folder) + " is not a folder");
    std::ifstream file(std::filesystem::path(folder) / path, std::ios::binary);
    if (file) return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  for (std::size_t i = 0; i < kEmbeddedKernelCount; i++) {
    const EmbeddedFile& file = kEmbeddedKernels[i];
    if (path == file.path) return {reinterpret_cast<const char*>(file.bytes), file.size};
  }
  throw InputError("kernels/" + path, "no such kernel source");
}

std::string flatten_kernels(const std::vector<std::string>& paths) {
  Flattener flattener;
  for (const std::string& path : paths) flattener.add(path);
  return flattener.take();
}

std::string name_sources(const std::string& log, const std::string& flattened) {
  const std::vector<std::string> places = places_of_lines(flattened);
  static const std::regex unnamed("<kernel>:([0-9]{1,9})");
  std::string named;
  auto rest = log.cbegin();
  for (std::sregex_iterator match(log.begin(), log.end(), unnamed), end; match != end; ++match) {
    const auto line = static_cast<std::size_t>(std::stoul((*match)[1]));
    named.append(rest, (*match)[0].first);
    named += line < places.size() && !places[line].empty() ? places[line] : match->str();
    rest = (*match)[0].second;
  }
  return named.append(rest, log.cend());
}

}  // namespace hemiray
