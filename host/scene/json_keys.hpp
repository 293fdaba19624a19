// Every key the JSON scene format knows, in one table: the loader refuses others, and a test holds scene.schema.json to
// the same lists.
#pragma once

#include <span>
#include <string_view>

namespace hemiray {

struct JsonKey {
  std::string_view name;
  bool required = false;
};

/// The keys of one kind of JSON object; `type` is also the name of its definition in scenes/scene.schema.json.
struct JsonKeyTable {
  std::string_view type;
  std::span<const JsonKey> keys;
};

/// All tables of the format.
std::span<const JsonKeyTable> json_key_tables();

/// The table of that type. Throws std::logic_error for a type that is none (a fault of the program).
const JsonKeyTable& json_keys(std::string_view type);

/// The values of "type" in objects and in lights; each has a key table of that name.
std::span<const std::string_view> json_object_types();
std::span<const std::string_view> json_light_types();

}  // namespace hemiray
