// View factors as files that other programs read.
#include <algorithm>
#include <bit>
#include <cctype>
#include <map>

#include <fmt/format.h>

#include "host/radiosity/view_factors.hpp"

namespace hemiray {
namespace {

constexpr std::size_t kView3dHead = 30;  // characters before the end of the first line

// As RFC 4180 wants it.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

// View3D separates by blanks.
std::string view3d_name(std::string name) {
  for (char& c : name) {
    if (std::isspace(static_cast<unsigned char>(c)) != 0 || c == '!') c = '_';
  }
  return name.empty() ? "area" : name;
}

}  // namespace

std::string factors_as_csv(const ViewFactors& f) {
  std::string text = "from,to,area_m2,factor,geometry_error,sampling_error,visibility_error,reciprocity_error\n";
  const std::size_t n = f.names.size();
  for (std::size_t i = 0; i < n; i++) {
    for (std::size_t j = 0; j < n; j++) {
      std::string split = ",,";
      if (!f.errors.empty()) {
        const ErrorSplit& e = f.errors[i * n + j];
        split = fmt::format("{:.3g},{:.3g},{:.3g}", e.geometry, e.sampling, e.visibility);
      }
      text += fmt::format("{},{},{:.9g},{:.9g},{},{:.3g}\n", csv_field(f.names[i]), csv_field(f.names[j]),
                          f.areas_m2[i], f.factors[i * n + j], split, f.reciprocity_errors[i * n + j]);
    }
  }
  return text;
}

std::string factors_as_npy(const ViewFactors& f) {
  static_assert(std::endian::native == std::endian::little);
  constexpr std::size_t kPrefix = 10, kAlignment = 64;
  std::string head = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({0}, {0}), }}", f.names.size());
  head.resize((kPrefix + head.size() + 1 + kAlignment - 1) / kAlignment * kAlignment - kPrefix - 1, ' ');
  head += '\n';
  std::string file("\x93NUMPY\x01\x00", 8);
  file += static_cast<char>(head.size() & 255U);
  file += static_cast<char>(head.size() >> 8U);
  file += head;
  file.append(reinterpret_cast<const char*>(f.factors.data()), f.factors.size() * sizeof(double));
  return file;
}

std::string factors_as_view3d(const ViewFactors& f, const std::vector<double>& emittances, bool closed) {
  const std::size_t n = f.names.size();
  std::string text = fmt::format("View3D 3.2 0 {} 0 {}", closed ? 1 : 0, n);
  text.resize(std::max(text.size(), kView3dHead), ' ');
  text += '\n';
  text += fmt::format("{:g}\n", fmt::join(f.areas_m2, " "));
  for (std::size_t i = 0; i < n; i++) {
    const auto* row = f.factors.data() + i * n;
    text += fmt::format("{:.6f}\n", fmt::join(row, row + n, " "));
  }
  return text + fmt::format("{:.3f}\n", fmt::join(emittances, " "));
}

std::string patches_as_view3d(const PatchMesh& mesh, const FactorGroups& groups, const std::string& title) {
  const std::vector<double> emittances = group_emittances(mesh, groups);
  std::string line = title;
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  std::string text = fmt::format("T {}\nC encl=0 list=0 eps=1.e-5\nF 3\n", line);
  std::map<std::uint32_t, std::size_t> numbers;  // of the vertices that patches have
  std::string surfaces;
  std::vector<std::size_t> first(groups.names.size(), 0);  // surface of each group that the others are combined with
  for (std::uint32_t patch = 0; patch < mesh.patch_count(); patch++) {
    const shared::uint4& t = mesh.flat.triangles[patch];
    std::size_t v[3];
    std::size_t corner = 0;
    for (const std::uint32_t vertex : {t.x, t.y, t.z}) {
      const auto [found, is_new] = numbers.try_emplace(vertex, numbers.size() + 1);
      if (is_new) {
        const float* p = &mesh.flat.positions[std::size_t{3} * vertex];
        text += fmt::format("V {} {:.9g} {:.9g} {:.9g}\n", found->second, p[0], p[1], p[2]);
      }
      v[corner++] = found->second;
    }
    const std::uint32_t group = groups.of_patch[patch];
    surfaces += fmt::format("S {} {} {} {} 0 0 {} {:.3f} {}\n", patch + 1, v[0], v[1], v[2], first[group],
                            emittances[group], view3d_name(groups.names[group]));
    if (first[group] == 0) first[group] = patch + 1;
  }
  return text + surfaces + "End of data\n";
}

}  // namespace hemiray
