// Strict JSON: a scan for nesting and NUL bytes, then nlohmann's SAX parser into a value of our own building, which
// sees doubled keys and knows where the parser stopped.
#include "host/base/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "host/base/error.hpp"
#include "host/base/spelling.hpp"

namespace hemiray {
namespace {

using nlohmann::json;

[[noreturn]] void fail_at(std::string_view text, std::size_t offset, const std::string& name, std::string_view what) {
  offset = std::min(offset, text.size());
  const std::string_view before = text.substr(0, offset);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t newline = before.rfind('\n');
  const std::size_t column = newline == std::string_view::npos ? offset + 1 : offset - newline;
  throw InputError(fmt::format("{}:{}:{}", name, line, column), what);
}

// The parser itself does not recurse, but everything that walks or destroys the value may.
void check_nesting(std::string_view text, const std::string& name, int max_depth) {
  bool in_string = false;
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\0') fail_at(text, i, name, "a NUL byte is not JSON");
    if (in_string) {
      if (c == '\\' && i + 1 < text.size() && text[i + 1] != '\0') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > max_depth) fail_at(text, i, name, fmt::format("nested deeper than {} levels", max_depth));
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
}

// The part of nlohmann's message that says what is wrong, without its own ids and places, on one line.
std::string plain_reason(std::string_view message) {
  for (const std::string_view mark : {std::string_view("column "), std::string_view("] ")}) {
    const std::size_t at = message.find(mark);
    if (at == std::string_view::npos) continue;
    message.remove_prefix(at + mark.size());
    if (mark == "column ") message.remove_prefix(std::min(message.find(": ") + 2, message.size()));
    break;
  }
  // "last read" shows everything since the last string or number, which misleads more than it helps.
  std::string kept(message);
  const std::size_t last_read = kept.find("; last read: '");
  const std::size_t expected = kept.rfind("'; expected ");
  if (last_read != std::string::npos) {
    kept.erase(last_read, expected == std::string::npos ? expected : expected + 1 - last_read);
  }
  message = kept;
  constexpr std::size_t kShown = 160;
  std::string reason;
  for (const char c : message.substr(0, kShown)) {
    const auto byte = static_cast<unsigned char>(c);
    reason += byte < 0x20U || byte >= 0x7FU ? '?' : c;
  }
  return message.size() > kShown ? reason + "..." : reason;
}

// Builds the value; the interface is nlohmann's.
class Builder : public nlohmann::json_sax<json> {
 public:
  Builder(std::string_view text, const std::string& name) : text_(text), name_(name) {}
  json take() { return std::move(root_); }

  bool null() override { return put(nullptr); }
  bool boolean(bool v) override { return put(v); }
  bool number_integer(number_integer_t v) override { return put(v); }
  bool number_unsigned(number_unsigned_t v) override { return put(v); }
  bool number_float(number_float_t v, const string_t&) override { return put(v); }
  bool string(string_t& v) override { return put(std::move(v)); }
  bool binary(binary_t&) override { return false; }  // never called for text
  bool start_object(std::size_t) override { return open(json::object()); }
  bool start_array(std::size_t) override { return open(json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    json& object = *stack_.back();
    const auto [member, fresh] = object.get_ref<json::object_t&>().emplace(name, nullptr);
    if (!fresh) throw InputError(place(), fmt::format("the key {} occurs twice", in_quotes(name)));
    slot_ = &member->second;
    keys_.back() = name;
    return true;
  }

  bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception& error) override {
    // `position` counts the bytes read, the offending one included; at the end of the text it may count one more.
    std::size_t offset = position <= text_.size() && position > 0 ? position - 1 : text_.size();
    constexpr int kNumberOverflow = 406;
    if (error.id == kNumberOverflow) {  // found at the number's end: show where it starts
      while (offset > 0 && std::string_view("0123456789+-.eE").find(text_[offset - 1]) != std::string_view::npos)
        --offset;
    }
    fail_at(text_, offset, name_, plain_reason(error.what()));
  }

 private:
  template <typename Value>
  json* place_value(Value&& value) {
    if (stack_.empty()) {
      root_ = std::forward<Value>(value);
      return &root_;
    }
    if (stack_.back()->is_array()) {
      stack_.back()->push_back(std::forward<Value>(value));
      return &stack_.back()->back();
    }
    *slot_ = std::forward<Value>(value);
    return slot_;
  }
  template <typename Value>
  bool put(Value&& value) {
    place_value(std::forward<Value>(value));
    return true;
  }
  bool open(json value) {
    stack_.push_back(place_value(std::move(value)));
    keys_.emplace_back();
    return true;
  }
  bool close() {
    stack_.pop_back();
    keys_.pop_back();
    return true;
  }
  // The path of the innermost open object.
  [[nodiscard]] std::string place() const {
    std::string path;
    for (std::size_t i = 0; i + 1 < stack_.size(); ++i) {
      path += stack_[i]->is_array() ? fmt::format("/{}", stack_[i]->size() - 1) : json_pointer_step(keys_[i]);
    }
    return path.empty() ? name_ : name_ + ": " + path;
  }

  std::string_view text_;
  const std::string& name_;
  json root_;
  std::vector<json*> stack_;       // open arrays and objects; an element stays put while it is open
  std::vector<std::string> keys_;  // the last key of each open object
  json* slot_ = nullptr;           // where the value of the last key goes
};

}  // namespace

std::string json_pointer_step(std::string_view key) {
  std::string step = "/";
  for (const char c : key) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '~') {
      step += "~0";
    } else if (c == '/') {
      step += "~1";
    } else if (byte < 0x20U || byte == 0x7FU) {
      step += fmt::format("\\x{:02x}", byte);
    } else {
      step += c;
    }
  }
  return step;
}

nlohmann::json parse_json_text(std::string_view text, const std::string& name, int max_depth) {
  check_nesting(text, name, max_depth);
  Builder builder(text, name);
  json::sax_parse(text.begin(), text.end(), &builder);
  return builder.take();
}

}  // namespace hemiray
