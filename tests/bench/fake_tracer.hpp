// A tracer that answers what it is told to, and notes when it is asked.
#pragma once

#include <string>
#include <vector>

#include "host/bench/tracer.hpp"

namespace hemiray::test {

class FakeTracer final : public bench::Tracer {
 public:
  FakeTracer(std::string tree, std::string way, std::vector<std::string>* diary = nullptr)
      : tree_(std::move(tree)), way_(std::move(way)), diary_(diary) {}

  std::size_t wrong = 0;  ///< the first so many rays are answered wrongly
  bool packets = false;
  bool shares = true;
  double build_ms = 1.0;

  std::string name() const override { return tree_ + "/" + way_; }
  std::string build_name() const override { return tree_; }
  bool in_packets() const override { return packets; }
  double build(const FlatScene& /*flat*/) override {
    note("build");
    return build_ms++;
  }
  bool share_build(const Tracer& other) override {
    const bool can = shares && other.build_name() == tree_;
    if (can) note("share");
    return can;
  }
  void load_rays(std::span<const shared::QueryRay> rays) override { count_ = rays.size(); }
  void intersect() override { note("intersect"); }
  void occluded() override { note("occluded"); }
  std::vector<shared::QueryHit> hits() override {
    std::vector<shared::QueryHit> all(count_, {1.0F, 0.0F, 0.0F, 7});
    for (std::size_t i = 0; i < wrong; i++) all[i].primitive = HR_NO_PRIMITIVE;
    return all;
  }
  std::vector<std::uint32_t> occlusions() override {
    std::vector<std::uint32_t> all(count_, 1);
    for (std::size_t i = 0; i < wrong; i++) all[i] = 0;
    return all;
  }

 private:
  void note(const std::string& what) {
    if (diary_ != nullptr) diary_->push_back(name() + " " + what);
  }
  std::string tree_, way_;
  std::vector<std::string>* diary_;
  std::size_t count_ = 0;
};

}  // namespace hemiray::test
