// What a reader tells the user without failing: each remark once, and never more than a screenful.
#pragma once

#include <cstddef>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

namespace hemiray {

/// Collects one-line notes for Scene::notes.
class Notes {
 public:
  /// Adds `text` unless it was added before. After kMaxNotes different ones a last line says that more were left out.
  void once(const std::string& text) {
    if (lines_.size() > kMaxNotes || !seen_.insert(text).second) return;
    lines_.push_back(lines_.size() < kMaxNotes ? text : "further notes are left out");
  }
  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

 private:
  static constexpr std::size_t kMaxNotes = 64;
  std::vector<std::string> lines_;
  std::unordered_set<std::string> seen_;
};

}  // namespace hemiray
