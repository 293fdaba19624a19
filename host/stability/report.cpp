#include "host/stability/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "host/base/numbers.hpp"
#include "host/stability/bounds.hpp"
#include "host/stability/compare_runs.hpp"
#include "host/stability/oracle.hpp"

namespace hemiray::stability {
namespace {

using nlohmann::ordered_json;

double rate(std::uint64_t count, const Tally& tally) {
  return tally.rays > 0 ? static_cast<double>(count) / static_cast<double>(tally.rays) : 0.0;
}

ordered_json to_json(const Tally& tally) {
  ordered_json json{{"rays", tally.rays}}, bounds, counts;
  const auto put = [&](std::string_view name, std::uint64_t count) {
    const std::string key(name);
    json[key] = rate(count, tally);
    bounds[key] = upper_bound(count, tally.rays);
    counts[key] = count;
  };
  for (const HeldRate& held : kHeldRates) put(held.name, tally.*held.count);
  put("borderline", tally.borderline);
  json["worst_ulps"] = tally.worst_ulps;
  json["upper_95"] = bounds;
  json["counts"] = counts;
  return json;
}

constexpr std::string_view kKinds[] = {"hits", "leaving", "picture"};

// A count, and its rate where that is not nothing.
std::string cell(std::uint64_t count, const Tally& tally) {
  return count == 0 ? "0" : fmt::format("{} ({:.1e})", count, rate(count, tally));
}

std::string ulps(const Tally& tally) {
  return tally.worst_ulps < 1000 ? fmt::format("{:.1f}", tally.worst_ulps) : fmt::format("{:.1e}", tally.worst_ulps);
}

std::string verdict(const CaseResults& results, const RungResult& rung) {
  if (!rung.broken.empty()) return "FAILS";
  for (const Allowance& one : allowances()) {
    if (one.case_name == results.name && one.rung == rung.rung) return "bound";
  }
  return "clean";
}

std::string hits_header(bool peer, bool implicit) {
  std::string text =
      "| rung | missed | false hit | wrong surface | packets: missed | false hit | borderline | worst ulps of t |";
  std::string rule = "|---|---|---|---|---|---|---|---|";
  if (implicit) {
    text += " uncertain | open regions |";
    rule += "---|---|";
  }
  if (peer) {
    text += " Embree: missed | false hit | wrong surface | borderline | worst ulps of t |";
    rule += "---|---|---|---|---|";
  }
  return text + " |\n" + rule + "---|\n";
}

std::string hits_row(const CaseResults& results, const RungResult& rung, bool peer, std::uint64_t asked) {
  const Tally& t = rung.ours;
  const Tally none, &k = rung.packets ? *rung.packets : none;
  const std::string name = t.rays < asked ? fmt::format("{} ({} rays)", rung.rung, t.rays) : rung.rung;
  std::string text = fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |", name, cell(t.missed, t),
                                 cell(t.false_hit, t), cell(t.wrong_surface, t), rung.packets ? cell(k.missed, k) : "-",
                                 rung.packets ? cell(k.false_hit, k) : "-", cell(t.borderline, t), ulps(t));
  if (rung.open_regions) text += fmt::format(" {} | {} |", cell(t.uncertain, t), cell(*rung.open_regions, t));
  if (peer && rung.peer) {
    const Tally& p = *rung.peer;
    text += fmt::format(" {} | {} | {} | {} | {} |", cell(p.missed, p), cell(p.false_hit, p), cell(p.wrong_surface, p),
                        cell(p.borderline, p), ulps(p));
  } else if (peer) {
    text += " | | | | |";
  }
  return text + fmt::format(" {} |\n", verdict(results, rung));
}

std::string other_row(const CaseResults& results, const RungResult& rung) {
  const Tally& t = rung.ours;
  return fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", rung.rung, t.rays, cell(t.missed, t),
                     cell(t.false_hit, t), cell(t.self_hit, t), cell(t.tunnelled, t), cell(t.borderline, t),
                     verdict(results, rung));
}

std::string markdown_table(const CaseResults& results, std::uint64_t asked) {
  std::string text = fmt::format("\n## {}\n{}\n\n", results.name, results.what);
  if (results.rungs.empty()) return text;
  if (results.name == "gap") {
    text +=
        "![The share of rays that pass the next surface, against the gap](images/tunnelling.svg)\n\nDrawn by `python3 "
        "bench/plot.py ladder.json docs/images` from what `--json ladder.json` wrote.\n\n";
  }
  const bool hits = results.rungs.front().kind == RungKind::hits;
  const bool peer = std::any_of(results.rungs.begin(), results.rungs.end(),
                                [](const RungResult& rung) { return rung.peer.has_value(); });
  text += hits ? hits_header(peer, results.rungs.front().open_regions.has_value())
               : "| rung | rays | missed | false hit | self-hit | tunnelled | borderline | |\n"
                 "|---|---|---|---|---|---|---|---|\n";
  for (const RungResult& rung : results.rungs) {
    text += hits ? hits_row(results, rung, peer, asked) : other_row(results, rung);
  }
  for (const RungResult& rung : results.rungs) {
    if (!rung.broken.empty()) text += fmt::format("\n- **{} FAILS**: {}", rung.rung, fmt::join(rung.broken, ", "));
    for (const Allowance& one : allowances()) {
      if (one.case_name != results.name || one.rung != rung.rung) continue;
      text += fmt::format("\n- {}: {} up to {:g} is expected: {}", rung.rung, one.rate, one.most, one.why);
    }
  }
  return text + "\n";
}

ordered_json comparisons_json(const Report& report) {
  const auto named = [](const std::vector<RungDifference>& rungs) {
    ordered_json list = ordered_json::array();
    for (const RungDifference& one : rungs) {
      list.push_back({{"case", one.case_name}, {"rung", one.rung}, {"what", one.what}});
    }
    return list;
  };
  ordered_json all = ordered_json::array();
  for (const Comparison& one : report.comparisons) {
    all.push_back({{"device", one.device},
                   {"platform", one.platform},
                   {"driver", one.driver},
                   {"commit", one.commit},
                   {"rungs", one.compared},
                   {"differences", named(one.differences)},
                   {"other_answers", named(one.other_answers)}});
  }
  return all;
}

// The smallest of the case's gaps from which on every ray goes where it should and nothing else is expected (which few
// rays might not show); empty if there is none.
std::string least_gap(const Report& report, const char* case_name) {
  std::string least;
  for (const CaseResults& one : report.cases) {
    if (one.name != case_name) continue;
    for (const RungResult& rung : one.rungs) {
      if (rung.ours.tunnelled + rung.ours.self_hit + rung.ours.missed > 0) break;
      if (most_allowed(case_name, rung.rung, "tunnelled") > 0.0) break;
      least = rung.rung;
    }
  }
  return least;
}

std::string smallest_gap(const Report& report) {
  const std::string world = least_gap(report, "gap"), instances = least_gap(report, "gap, instances");
  std::string text;
  if (!world.empty()) {
    text += fmt::format(
        " The smallest gap between two surfaces that is resolved by every ray: {} of the distance from the origin",
        world);
  }
  if (!instances.empty())
    text += fmt::format("{} {} in instances", world.empty() ? " The smallest gap is" : ",", instances);
  return text.empty() ? text : text + ".";
}

std::size_t count_rungs(const Report& report) {
  std::size_t count = 0;
  for (const CaseResults& one : report.cases) count += one.rungs.size();
  return count;
}

std::size_t count_failing(const Report& report) {
  std::size_t count = 0;
  for (const CaseResults& one : report.cases) {
    count += static_cast<std::size_t>(
        std::count_if(one.rungs.begin(), one.rungs.end(), [](const RungResult& rung) { return !rung.broken.empty(); }));
  }
  return count;
}

}  // namespace

bool holds(const Report& report) { return count_failing(report) == 0; }

std::string report_head(const Report& report) {
  return fmt::format("{} ({}, {})\n{}, {} rays a rung, seed {}, {} precision{}{}\n", report.machine.device,
                     report.machine.platform, report.machine.driver, report.machine.processor, report.rays, report.seed,
                     report.precision, report.strict ? ", strict" : "",
                     report.machine.peer.empty() ? "" : ", beside " + report.machine.peer);
}

std::string case_table(const CaseResults& results) {
  std::string text = fmt::format("{}: {}\n", results.name, results.what);
  text += fmt::format("  {:<22}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>11}{:>11}\n", "", "rays", "missed", "false", "wrong",
                      "self-hit", "tunnel", "borderline", "ulps of t");
  for (const RungResult& rung : results.rungs) {
    const auto row = [&](const std::string& name, const Tally& t) {
      text += fmt::format("  {:<22}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>11}{:>11}", name, t.rays, t.missed, t.false_hit,
                          t.wrong_surface, t.self_hit, t.tunnelled, t.borderline, ulps(t));
    };
    row(rung.rung, rung.ours);
    if (rung.open_regions) {
      text += fmt::format("  uncertain {}, open regions {}", rung.ours.uncertain, *rung.open_regions);
    }
    const std::string word = verdict(results, rung);
    text += rung.broken.empty() ? (word == "clean" ? "\n" : fmt::format("  {}\n", word))
                                : fmt::format("  FAILS: {}\n", fmt::join(rung.broken, ", "));
    if (rung.packets && rung.other_bits > 0) {
      row("  in packets", *rung.packets);
      text += "\n";
    }
    if (rung.peer) {
      row("  Embree", *rung.peer);
      text += "\n";
    }
  }
  return text;
}

std::string report_json(const Report& report) {
  ordered_json cases = ordered_json::array();
  for (const CaseResults& one : report.cases) {
    ordered_json rungs = ordered_json::array();
    for (const RungResult& rung : one.rungs) {
      ordered_json json{{"rung", rung.rung}, {"kind", kKinds[static_cast<std::size_t>(rung.kind)]}};
      json["answers"] = rung.answers;
      json.update(to_json(rung.ours));
      ordered_json allowed = ordered_json::object();
      for (const HeldRate& held : kHeldRates) {
        allowed[std::string(held.name)] = most_allowed(one.name, rung.rung, held.name);
      }
      json["allowed"] = allowed;
      json["holds"] = rung.broken.empty();
      json["broken"] = rung.broken;
      json["packets"] = rung.packets ? to_json(*rung.packets) : ordered_json(nullptr);
      json[std::string(kOtherBits)] = rung.other_bits;
      json[std::string(kOpenRegions)] = rung.open_regions ? ordered_json(*rung.open_regions) : ordered_json(nullptr);
      json["peer"] = rung.peer ? to_json(*rung.peer) : ordered_json(nullptr);
      rungs.push_back(std::move(json));
    }
    cases.push_back({{"case", one.name}, {"what", one.what}, {"rungs", std::move(rungs)}});
  }
  ordered_json peer = nullptr;
  if (!report.machine.peer.empty()) peer = report.machine.peer;
  const ordered_json all{{"date", report.date},
                         {"device", report.machine.device},
                         {"platform", report.machine.platform},
                         {"driver", report.machine.driver},
                         {"processor", report.machine.processor},
                         {"version", report.machine.version},
                         {"commit", report.machine.commit},
                         {"peer", peer},
                         {"rays", report.rays},
                         {"seed", report.seed},
                         {"seconds", report.seconds},
                         {"bound_ulps", kBoundUlps},
                         {"complete", report.complete},
                         {"precision", report.precision},
                         {"strict", report.strict},
                         {"holds", holds(report)},
                         {"comparisons", comparisons_json(report)},
                         {"cases", cases}};
  return all.dump(2) + "\n";
}

std::string report_markdown(const Report& report) {
  const bench::Machine& m = report.machine;
  std::string text = "# Stability\n";
  text += fmt::format("Hard cases, each a ladder of rungs, and what comes of them. Written by `{}`, not by hand.\n\n",
                      report.command);
  text += "| | |\n|---|---|\n";
  text += fmt::format("| date | {} |\n| commit | {} |\n| device | {} ({}, driver {}) |\n| processor | {} |\n",
                      report.date, m.commit, m.device, m.platform, m.driver, m.processor);
  if (!m.peer.empty())
    text += fmt::format(
        "| beside us | {}, ROBUST scene, single rays, the same rays, in cases that are triangles' "
        "alone and ask for hits |\n",
        m.peer);
  text += fmt::format(
      "| rays a rung | {}, seed {}; where none of them fails, the rate is below {:.1e} with 95 % confidence (Clopper "
      "and Pearson); where there are fewer rays (implicit surfaces, many triangles in one place, pictures: a pixel "
      "for 16 rays) the tables say how many, and the rate is below 3 over their number |\n",
      report.rays, report.seed, upper_bound(0, report.rays));
  text += fmt::format("| time | {} |\n", format_duration(report.seconds));
  text += fmt::format("| rungs | {}, of which {} fail{} |\n\n", count_rungs(report), count_failing(report),
                      report.complete ? "" : " (some are left out)");
  if (report.strict) text += "Compiled strict (`--strict`).\n\n";
  if (report.precision == "double") text += "In double precision (`--precision double`).\n\n";
  text += fmt::format(
      "Rays are aimed at vertices, edges, corners and planes of boxes, half of them moved by up to 3 ulps; random rays "
      "prove little. Every answer is judged by what the exact ray through the same floats meets (long double with an "
      "error bound, integers of 1024 bits or 50 digits where that is not sure).{}\n\n",
      smallest_gap(report));
  text += fmt::format(
      "- **missed**: something surely is there, and the answer is none or a farther one. Inside closed meshes every "
      "miss "
      "counts.\n"
      "- **false hit**: what is named is not met, or the point lies farther off it than the bound.\n"
      "- **wrong surface**: what is named is met, but another is nearer by more than the bound (it is missed, too).\n"
      "- **packets**: the same rays traced in packets, 64 from a point; 2 % of a rung may differ from single rays in "
      "bits (ties in planes between boxes), and rays asked for any hit must agree; a line below the table says where "
      "that fails.\n"
      "- **self-hit**, **tunnelled**: a ray that goes on from a hit, as the renderer sends it, meets the surface that "
      "it left, or passes the next one.\n"
      "- **uncertain**: of an implicit surface a hit is missed, and the device, asked for that ray alone, says that it "
      "cannot tell; **open regions**: in how many parts of rays it says so, whether anything is there or not.\n"
      "- **borderline**: at an outline, within the bound of it, where the answer is not the exact one. These are "
      "right.\n"
      "- **The bound**: an answer is right if it is exact for vertices that lie, seen from the ray's origin, within "
      "{:g} "
      "ulps of their distance from it of where they should (`host/stability/oracle.hpp`; for spheres the radius, by "
      "{:g} ulps of distance and radius; for disks, cones, cylinders and quadrics 4e-6 of their reach and 2 ulps of t, "
      "`shape_oracle.hpp`; for implicit surfaces {:g} ulps of t, or a value that float-float cannot tell from zero, "
      "`implicit_oracle.hpp`).\n"
      "- **worst ulps of t**: how far t is off at most, over hits that the exact ray has, too (of shapes and implicit "
      "surfaces in ulps of the origin's coordinates, where those are larger). Along a surface, and on "
      "thin triangles, it is ill-conditioned.\n"
      "- A rung is **clean** where nothing is missed, false, wrong, self-hit or tunnelled; **bound** where more is "
      "expected of single precision and stated below the table (`host/stability/bounds.cpp`); else it **FAILS**.\n",
      kBoundUlps, kBoundUlps, kBoundUlps);
  if (!report.comparisons.empty()) text += "\n## Across devices\n";
  for (const Comparison& one : report.comparisons) text += comparison_markdown(one);
  for (const CaseResults& one : report.cases) text += markdown_table(one, report.rays);
  return text;
}

}  // namespace hemiray::stability
