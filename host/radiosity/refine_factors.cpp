#include "host/radiosity/refine_factors.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace hemiray {
namespace {

// A part may look out of the room where the whole did not: then its row is off one by more than this, and left so.
constexpr double kPartSlack = 0.05;

constexpr std::size_t kBlockEntries = std::size_t{1} << 23U;  // so that blocks do not outgrow what devices allocate

class Assembler {
 public:
  Assembler(Context& context, const RefinedMesh& refined, bool paired)
      : context_(context), refined_(refined), paired_(paired), parts_(refined.mesh.patch_count()) {
    for (const std::uint32_t part : refined.parts) parts_[refined.parents[part]].push_back(part);
    shares_.resize(refined.mesh.side_count(), 0.0F);
  }

  // What is left of the rows of `old`, with those of the parts. Values: by hemicubes factors, as in both of these; pair
  // by pair exchange areas, as in `fresh`.
  FactorMatrix assemble(const FactorMatrix& old, const FactorMatrix& fresh) {
    matrix_.side_count = refined_.mesh.side_count();
    std::vector<FactorRow> to_parts(matrix_.side_count);  // what sides exchange with parts [m^2], those ascending
    for (const FactorBlock& block : fresh.blocks) {
      SideRows made = read_rows(block);
      for (std::size_t k = 0; k < made.sides.size(); k++) {
        const std::uint32_t part = made.sides[k];
        for (const auto& [side, value] : made.rows[k]) {
          to_parts[side].emplace_back(part, paired_ ? value : value * area_of(part));
        }
        std::ranges::sort(made.rows[k]);
        add(part, std::move(made.rows[k]));
      }
    }
    for (const FactorBlock& block : old.blocks) {
      SideRows kept = read_rows(block);
      for (std::size_t k = 0; k < kept.sides.size(); k++) {
        const std::uint32_t side = kept.sides[k];
        if (is_cut(side)) continue;
        add(side,
            paired_ ? by_reciprocity(side, kept.rows[k], to_parts[side]) : shared_out(kept.rows[k], to_parts[side]));
        to_parts[side] = {};
      }
    }
    write();
    return std::move(matrix_);
  }

 private:
  [[nodiscard]] float area_of(std::uint32_t side) const { return refined_.mesh.normals[side / 2].w; }
  [[nodiscard]] bool is_cut(std::uint32_t old_side) const { return !parts_[old_side / 2].empty(); }

  FactorRow by_reciprocity(std::uint32_t side, const FactorRow& row, const FactorRow& to_parts) const {
    FactorRow result = to_parts;
    for (const auto& [column, value] : row) {
      if (!is_cut(column)) result.emplace_back(column, value * area_of(side));
    }
    std::ranges::sort(result);
    return result;
  }

  FactorRow shared_out(const FactorRow& row, const FactorRow& to_parts) {
    FactorRow result;
    for (const auto& [part, exchange] : to_parts) shares_[part] = exchange;
    for (const auto& [column, value] : row) {
      if (!is_cut(column)) {
        result.emplace_back(column, value);
        continue;
      }
      const std::vector<std::uint32_t>& parts = parts_[column / 2];
      float seen = 0.0F, area = 0.0F;
      for (const std::uint32_t part : parts) {
        seen += shares_[2 * part + column % 2];
        area += area_of(2 * part);
      }
      for (const std::uint32_t part : parts) {
        const std::uint32_t side = 2 * part + column % 2;
        const float share = seen > 0.0F ? shares_[side] / seen : area_of(side) / area;
        if (share > 0.0F) result.emplace_back(side, value * share);
      }
    }
    for (const auto& [part, exchange] : to_parts) shares_[part] = 0.0F;
    std::ranges::sort(result);
    return result;
  }

  void add(std::uint32_t side, FactorRow row) {
    if (entries_ + row.size() > kBlockEntries) write();
    entries_ += row.size();
    pending_.sides.push_back(side);
    pending_.rows.push_back(std::move(row));
  }

  void write() {
    if (!pending_.sides.empty()) matrix_.blocks.push_back(make_block(context_, pending_));
    pending_ = {};
    entries_ = 0;
  }

  Context& context_;
  const RefinedMesh& refined_;
  bool paired_;
  std::vector<std::vector<std::uint32_t>> parts_;  // of the patches before; of those that are whole: none
  std::vector<float> shares_;                      // by side, 0 between rows
  FactorMatrix matrix_;
  SideRows pending_;
  std::size_t entries_ = 0;
};

std::vector<bool> sides_with_rows(const FactorMatrix& matrix) {
  std::vector<bool> has(matrix.side_count, false);
  for (const FactorBlock& block : matrix.blocks) {
    for (const std::uint32_t side : block.rows.read()) has[side] = true;
  }
  return has;
}

// By side of the refined mesh, what held for the sides before.
std::vector<bool> inherited(const RefinedMesh& refined, const std::vector<bool>& before) {
  std::vector<bool> now(refined.mesh.side_count());
  for (std::uint32_t side = 0; side < now.size(); side++) now[side] = before[2 * refined.parents[side / 2] + side % 2];
  return now;
}

// Those of the parts, then those next to them, whose rays tell which pairs are partly hidden, then all others.
PairSides pair_sides_of(Context& context, const RefinedMesh& refined, const std::vector<bool>& active) {
  const FlatScene& flat = refined.mesh.flat;
  std::vector<bool> is_part(refined.mesh.patch_count(), false), touched(flat.positions.size() / 3, false);
  for (const std::uint32_t part : refined.parts) {
    is_part[part] = true;
    const shared::uint4& t = flat.triangles[part];
    touched[t.x] = touched[t.y] = touched[t.z] = true;
  }
  std::vector<std::uint32_t> parts, next, others;
  for (std::uint32_t side = 0; side < refined.mesh.side_count(); side++) {
    if (!active[side]) continue;
    const shared::uint4& t = flat.triangles[side / 2];
    const int corners = (touched[t.x] ? 1 : 0) + (touched[t.y] ? 1 : 0) + (touched[t.z] ? 1 : 0);
    (is_part[side / 2] ? parts : corners >= 2 ? next : others).push_back(side);
  }
  const auto rows = static_cast<std::uint32_t>(parts.size()), traced = rows + static_cast<std::uint32_t>(next.size());
  parts.insert(parts.end(), next.begin(), next.end());
  parts.insert(parts.end(), others.begin(), others.end());
  return {context, refined.mesh, parts, rows, traced};
}

}  // namespace

RefinedFactors refine_factors(Context& context, Parallel& parallel, Hemicubes& hemicubes, const FactorMatrix& old,
                              const RefinedMesh& refined, const FactorOptions& options,
                              const std::function<bool(double)>& on_progress) {
  RefinedFactors result;
  const PatchMesh& mesh = refined.mesh;
  std::vector<bool> active = inherited(refined, sides_with_rows(old));
  std::vector<std::uint32_t> rows;
  for (const std::uint32_t part : refined.parts) {
    for (const std::uint32_t side : {2 * part, 2 * part + 1}) {
      const shared::float4& e = mesh.emission[side];
      if (e.x > 0.0F || e.y > 0.0F || e.z > 0.0F) active[side] = true;
      if (active[side]) rows.push_back(side);
    }
  }
  result.made_rows = rows.size();
  const auto go_on = [&](double fraction) {
    result.interrupted |= on_progress && !on_progress(fraction);
    return !result.interrupted;
  };
  const bool paired = options.method != FormFactors::hemicube;
  FactorMatrix fresh;
  if (paired) {
    constexpr double kVisibilityShare = 0.8;  // of the time
    const PairSides sides = pair_sides_of(context, refined, active);
    const PairVisibility visibility = find_visibility(context, parallel, mesh, sides, options.visibility,
                                                      [&](double f) { return go_on(kVisibilityShare * f); });
    result.rays = visibility.rays;
    fresh = make_pair_factors(context, parallel, sides, visibility, {}, [&](double f) {
              return go_on(kVisibilityShare + (1.0 - kVisibilityShare) * f);
            }).matrix;
  } else {
    const std::uint64_t before = hemicubes.rays_traced();
    hemicubes.add_rows(rows, fresh, [&](std::uint64_t done) {
      return go_on(static_cast<double>(done) / static_cast<double>(rows.size()));
    });
    context.finish();  // before `rows` go
    result.rays = hemicubes.rays_traced() - before;
  }
  if (result.interrupted) return result;
  std::vector<double> slack(mesh.side_count(), -1.0);
  const std::vector<bool> closed = inherited(refined, closed_rows(old));
  for (std::size_t s = 0; s < slack.size(); s++) slack[s] = closed[s] ? kPartSlack : -1.0;
  result.matrix = Assembler(context, refined, paired).assemble(old, fresh);
  if (paired) {
    scale_pairs(context, mesh, result.matrix, slack, options.method == FormFactors::hybrid);
    context.finish();
  }
  return result;
}

}  // namespace hemiray
