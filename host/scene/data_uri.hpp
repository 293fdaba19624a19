// URIs in scene files: data: URIs, percent encoding, and names of files beside the scene.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hemiray {

/// Decodes RFC 4648 base64, padded or not, without blanks. Throws InputError(place, ...).
std::vector<std::uint8_t> decode_base64(std::string_view text, const std::string& place);

/// Replaces %XX by the byte. Throws InputError(place, ...) for malformed sequences and NUL bytes.
std::string decode_percent(std::string_view text, const std::string& place);

bool is_data_uri(std::string_view uri);

/// The payload of "data:[media type][;base64],payload". Throws InputError(place, ...).
std::vector<std::uint8_t> decode_data_uri(std::string_view uri, const std::string& place);

/// The relative file name a URI stands for. Throws InputError(place, ...) for absolute paths and for URIs with a scheme
/// (http: and the like): a scene reads only files it comes with.
std::string file_of_uri(std::string_view uri, const std::string& place);

}  // namespace hemiray
