// JSON text to a JSON value, strictly: one place for everything RFC 8259 leaves to the reader.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace hemiray {

/// Parses a whole JSON text. `name` stands for the file in messages; `max_depth` is the deepest nesting of arrays and
/// objects accepted. Comments, NaN, Infinity, numbers beyond double, NUL bytes and ill-formed UTF-8 are errors.
/// Throws InputError "name:line:column: ..." (columns count bytes, from 1), and "name: /json/path: ..." for a key that
/// occurs twice in one object.
nlohmann::json parse_json_text(std::string_view text, const std::string& name, int max_depth);

/// `key` as one step of a JSON pointer (RFC 6901), with control characters escaped so that messages stay on one line.
std::string json_pointer_step(std::string_view key);

}  // namespace hemiray
