#include "host/scene/expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <utility>

#include "host/base/spelling.hpp"
#include "host/scene/tape_value.hpp"

namespace hemiray {
namespace {

constexpr int kMaxNesting = 100;
constexpr std::uint32_t kMaxExponent = 16;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// A node of the tree; constants are folded, so only whole subtrees without x, y and z are of kind `constant`.
struct Node {
  enum class Kind { constant, coordinate, sum, difference, product, negative, power };
  Kind kind = Kind::constant;
  double value = 0.0;        // of a constant
  std::uint32_t number = 0;  // of a coordinate: which; of a power: the exponent
  std::size_t left = 0, right = 0;
  std::uint32_t degree = 0;
  std::uint32_t stack = 1;  // entries of the stack it needs
  std::size_t length = 1;   // instructions
};

class Parser {
 public:
  Parser(std::string_view text, const ExpressionConstants& constants) : text_(text), constants_(constants) {}

  Expression run() {
    if (text_.size() > kMaxExpressionLength) {
      fail(kMaxExpressionLength, fmt::format("an expression has at most {} bytes", kMaxExpressionLength));
    }
    const std::size_t written = sum();
    if (pos_ < text_.size()) fail(pos_, text_[pos_] == ')' ? "this parenthesis closes none" : expected("an operator"));
    const std::size_t root = without_repeated_factors(written);
    if (nodes_[root].kind == Node::Kind::constant) fail(0, "the expression does not depend on x, y or z");
    if (nodes_[root].stack > HR_TAPE_STACK) {
      fail(0,
           fmt::format("nested too deeply: {} parts wait for each other, at most {} can; start with the longest part "
                       "of each sum and product",
                       nodes_[root].stack, HR_TAPE_STACK));
    }
    Expression result;
    emit(root, result.tape);
    result.degree = nodes_[root].degree;
    result.written_degree = nodes_[written].degree;
    result.stack = nodes_[root].stack;
    return result;
  }

 private:
  [[noreturn]] void fail(std::size_t at, const std::string& message) const { throw ExpressionError(at + 1, message); }

  [[nodiscard]] std::string expected(std::string_view what) const {
    return fmt::format("expected {}, found {}", what,
                       pos_ < text_.size() ? in_quotes(first_character(text_.substr(pos_))) : std::string("the end"));
  }

  void skip_blanks() {
    while (pos_ < text_.size() && (text_[pos_] == ' ' || text_[pos_] == '\t' || text_[pos_] == '\n')) pos_++;
  }
  // Whether the next character is c, which it then passes, with the blanks behind it.
  bool take(char c) {
    if (pos_ >= text_.size() || text_[pos_] != c) return false;
    pos_++;
    skip_blanks();
    return true;
  }

  std::size_t add(Node node, std::size_t at) {
    if (node.kind == Node::Kind::constant) {
      const double size = std::abs(node.value);
      if (!(size == 0.0 || (size >= 1.0 / kMaxExpressionConstant && size <= kMaxExpressionConstant))) {
        fail(at, fmt::format("the constant {:g} is neither 0 nor between {:g} and {:g}", node.value,
                             1.0 / kMaxExpressionConstant, kMaxExpressionConstant));
      }
    }
    if (node.degree > HR_MAX_DEGREE) {
      fail(at, fmt::format("the degree is {} here, and may be at most {}", node.degree, HR_MAX_DEGREE));
    }
    if (node.length > HR_TAPE_LENGTH) {
      fail(at, fmt::format("the expression needs more than {} instructions", HR_TAPE_LENGTH));
    }
    nodes_.push_back(node);
    return nodes_.size() - 1;
  }

  std::size_t constant(double value, std::size_t at) { return add({.value = value}, at); }

  std::size_t negative(std::size_t child, std::size_t at) {
    if (nodes_[child].kind == Node::Kind::constant) return constant(-nodes_[child].value, at);
    Node node = nodes_[child];
    node.kind = Node::Kind::negative;
    node.left = child;
    node.length += 1;
    return add(node, at);
  }

  std::size_t binary(Node::Kind kind, std::size_t left, std::size_t right, std::size_t at) {
    const Node a = nodes_[left], b = nodes_[right];
    const bool a_constant = a.kind == Node::Kind::constant, b_constant = b.kind == Node::Kind::constant;
    if (a_constant && b_constant) {
      return constant(kind == Node::Kind::product      ? a.value * b.value
                      : kind == Node::Kind::difference ? a.value - b.value
                                                       : a.value + b.value,
                      at);
    }
    if (kind == Node::Kind::product && ((a_constant && a.value == 0.0) || (b_constant && b.value == 0.0))) {
      return constant(0.0, at);
    }
    Node node{.kind = kind, .left = left, .right = right};
    node.degree = kind == Node::Kind::product ? a.degree + b.degree : std::max(a.degree, b.degree);
    if (a_constant || b_constant) {  // the constant is part of the instruction
      node.stack = a_constant ? b.stack : a.stack;
      node.length = (a_constant ? b.length : a.length) + (kind == Node::Kind::difference && a_constant ? 2 : 1);
    } else {  // the deeper part comes first (Sethi and Ullman 1970)
      node.stack = a.stack == b.stack ? a.stack + 1 : std::max(a.stack, b.stack);
      node.length = a.length + b.length + 1;
    }
    return add(node, at);
  }

  std::size_t power(std::size_t base, std::uint32_t exponent, std::size_t at) {
    const Node child = nodes_[base];
    if (child.kind == Node::Kind::constant) {
      double value = 1.0;
      for (std::uint32_t i = 0; i < exponent; i++) value *= child.value;
      return constant(value, at);
    }
    if (exponent == 0) return constant(1.0, at);
    if (exponent == 1) return base;
    Node node{.kind = Node::Kind::power, .number = exponent, .left = base};
    node.degree = child.degree * exponent;
    const bool squares_only = std::has_single_bit(exponent);
    node.stack = squares_only ? child.stack : std::max(child.stack, 2U);
    node.length = child.length + static_cast<std::size_t>(std::bit_width(exponent)) - 1;
    if (!squares_only) node.length += static_cast<std::size_t>(std::popcount(exponent)) + 1;
    return add(node, at);
  }

  [[nodiscard]] bool same(std::size_t left, std::size_t right) const {
    const Node &a = nodes_[left], &b = nodes_[right];
    if (a.kind != b.kind || a.value != b.value || a.number != b.number || a.length != b.length) return false;
    if (a.kind == Node::Kind::constant || a.kind == Node::Kind::coordinate) return true;
    const bool one_child = a.kind == Node::Kind::negative || a.kind == Node::Kind::power;
    return same(a.left, b.left) && (one_child || same(a.right, b.right));
  }

  struct Factors {
    std::vector<std::size_t> different;  // none constant
    bool negative = false;
    bool repeated = false;
  };

  void collect_factors(std::size_t index, Factors& factors) const {
    const Node& node = nodes_[index];
    if (node.kind == Node::Kind::product) {
      collect_factors(node.left, factors);
      collect_factors(node.right, factors);
    } else if (node.kind == Node::Kind::power) {
      factors.repeated = true;
      collect_factors(node.left, factors);
    } else if (node.kind == Node::Kind::negative) {
      factors.negative = !factors.negative;
      collect_factors(node.left, factors);
    } else if (node.kind == Node::Kind::constant) {
      if (node.value < 0.0) factors.negative = !factors.negative;
    } else if (std::any_of(factors.different.begin(), factors.different.end(),
                           [&](std::size_t other) { return same(index, other); })) {
      factors.repeated = true;
    } else {
      factors.different.push_back(index);
    }
  }

  // c p^j q^k ... is zero where p q ... is, and there a ray meets it in simple roots, which can be told. As far as the
  // text shows: factors are the same where their trees are.
  std::size_t without_repeated_factors(std::size_t root) {
    Factors factors;
    collect_factors(root, factors);
    if (!factors.repeated) return root;
    std::size_t result = factors.different[0];
    for (std::size_t i = 1; i < factors.different.size(); i++) {
      result = binary(Node::Kind::product, result, factors.different[i], 0);
    }
    return factors.negative ? negative(result, 0) : result;
  }

  std::size_t sum() {
    if (++nesting_ > kMaxNesting) fail(pos_, fmt::format("more than {} parentheses and signs are open", kMaxNesting));
    skip_blanks();
    std::size_t left = product();
    for (;;) {
      const std::size_t at = pos_;
      if (take('+')) {
        left = binary(Node::Kind::sum, left, product(), at);
      } else if (take('-')) {
        left = binary(Node::Kind::difference, left, product(), at);
      } else {
        nesting_--;
        return left;
      }
    }
  }

  std::size_t product() {
    std::size_t left = signed_factor();
    for (;;) {
      const std::size_t at = pos_;
      if (take('*')) {
        left = binary(Node::Kind::product, left, signed_factor(), at);
      } else if (take('/')) {
        const std::size_t below = pos_;
        const std::size_t right = signed_factor();
        if (nodes_[right].kind != Node::Kind::constant) fail(below, "only division by constants gives a polynomial");
        if (nodes_[right].value == 0.0) fail(below, "division by zero");
        if (nodes_[left].kind == Node::Kind::constant) {
          left = constant(nodes_[left].value / nodes_[right].value, at);
        } else {
          left = binary(Node::Kind::product, left, constant(1.0 / nodes_[right].value, below), at);
        }
      } else {
        return left;
      }
    }
  }

  // -x^2 is -(x^2).
  std::size_t signed_factor() {
    const std::size_t at = pos_;
    if (++nesting_ > kMaxNesting) fail(at, fmt::format("more than {} parentheses and signs are open", kMaxNesting));
    std::size_t result = 0;
    if (take('-')) {
      result = negative(signed_factor(), at);
    } else if (take('+')) {
      result = signed_factor();
    } else {
      result = raised();
    }
    nesting_--;
    return result;
  }

  std::size_t raised() {
    const std::size_t base = atom();
    const std::size_t at = pos_;
    if (!take('^')) return base;
    const std::size_t begin = pos_;
    std::uint32_t exponent = 0;
    while (pos_ < text_.size() && is_digit(text_[pos_]) && exponent <= kMaxExponent) {
      exponent = 10 * exponent + static_cast<std::uint32_t>(text_[pos_++] - '0');
    }
    if (pos_ == begin) fail(pos_, expected("an exponent, a whole number"));
    if (exponent > kMaxExponent) fail(begin, fmt::format("an exponent is at most {}", kMaxExponent));
    if (pos_ < text_.size() && (text_[pos_] == '.' || is_letter(text_[pos_]))) {
      fail(pos_, "an exponent is a whole number without a point");
    }
    skip_blanks();
    if (pos_ < text_.size() && text_[pos_] == '^') fail(pos_, "a power of a power needs parentheses");
    return power(base, exponent, at);
  }

  std::size_t atom() {
    const std::size_t at = pos_;
    if (take('(')) {
      const std::size_t inside = sum();
      if (!take(')')) fail(pos_, expected("an operator or a closing parenthesis"));
      return inside;
    }
    if (pos_ < text_.size() && (is_digit(text_[pos_]) || text_[pos_] == '.')) return number();
    if (pos_ >= text_.size() || !is_letter(text_[pos_])) {
      fail(pos_, expected("a number, a name or an opening parenthesis"));
    }
    while (pos_ < text_.size() && (is_letter(text_[pos_]) || is_digit(text_[pos_]) || text_[pos_] == '_')) pos_++;
    const std::string_view name = text_.substr(at, pos_ - at);
    skip_blanks();
    if (name.size() == 1 && name[0] >= 'x' && name[0] <= 'z') {
      return add({.kind = Node::Kind::coordinate, .number = static_cast<std::uint32_t>(name[0] - 'x'), .degree = 1},
                 at);
    }
    const auto found = constants_.find(name);
    if (found == constants_.end()) {
      std::vector<std::string_view> known = {"x", "y", "z"};
      for (const auto& [constant_name, value] : constants_) known.push_back(constant_name);
      fail(at, fmt::format("{} is neither x, y, z nor one of the constants{}", in_quotes(name),
                           spelling_hint(name, known)));
    }
    return constant(found->second, at);
  }

  std::size_t number() {
    const std::size_t at = pos_;
    double value = 0.0;
    const char* const end = text_.data() + text_.size();
    const auto [stop, error] = std::from_chars(text_.data() + pos_, end, value);
    if (error == std::errc::result_out_of_range) fail(at, "this number is too large or too small");
    if (error != std::errc()) fail(at, expected("a number"));
    pos_ = static_cast<std::size_t>(stop - text_.data());
    skip_blanks();
    return constant(value, at);
  }

  static shared::uint4 instruction(std::uint32_t op, double value = 0.0) {
    const auto high = static_cast<float>(value);
    const auto low = static_cast<float>(value - static_cast<double>(high));
    return {op, 0, std::bit_cast<std::uint32_t>(high), std::bit_cast<std::uint32_t>(low)};
  }

  void emit(std::size_t index, std::vector<shared::uint4>& tape) const {
    const Node& node = nodes_[index];
    const auto put = [&tape](std::uint32_t op, double value = 0.0) { tape.push_back(instruction(op, value)); };
    switch (node.kind) {
      case Node::Kind::constant:
        put(HR_TAPE_PUSH, node.value);
        return;
      case Node::Kind::coordinate:
        put(HR_TAPE_X + node.number);
        return;
      case Node::Kind::negative:
        emit(node.left, tape);
        put(HR_TAPE_NEG);
        return;
      case Node::Kind::power: {
        emit(node.left, tape);
        const bool squares_only = std::has_single_bit(node.number);
        if (!squares_only) put(HR_TAPE_DUP);
        for (int bit = std::bit_width(node.number) - 2; bit >= 0; bit--) {
          put(HR_TAPE_SQR);
          if ((node.number >> static_cast<unsigned>(bit) & 1U) != 0) put(HR_TAPE_MUL_UNDER);
        }
        if (!squares_only) put(HR_TAPE_NIP);
        return;
      }
      default:
        emit_binary(node, tape);
        return;
    }
  }

  void emit_binary(const Node& node, std::vector<shared::uint4>& tape) const {
    const Node &a = nodes_[node.left], &b = nodes_[node.right];
    const bool product = node.kind == Node::Kind::product, difference = node.kind == Node::Kind::difference;
    if (a.kind == Node::Kind::constant) {
      emit(node.right, tape);
      if (difference) tape.push_back(instruction(HR_TAPE_NEG));
      tape.push_back(instruction(product ? HR_TAPE_MUL_CONST : HR_TAPE_ADD_CONST, a.value));
    } else if (b.kind == Node::Kind::constant) {
      emit(node.left, tape);
      tape.push_back(instruction(product ? HR_TAPE_MUL_CONST : HR_TAPE_ADD_CONST, difference ? -b.value : b.value));
    } else {
      const bool swapped = b.stack > a.stack;
      emit(swapped ? node.right : node.left, tape);
      emit(swapped ? node.left : node.right, tape);
      tape.push_back(instruction(product      ? HR_TAPE_MUL
                                 : difference ? (swapped ? HR_TAPE_RSUB : HR_TAPE_SUB)
                                              : HR_TAPE_ADD));
    }
  }

  std::string_view text_;
  const ExpressionConstants& constants_;
  std::vector<Node> nodes_;
  std::size_t pos_ = 0;
  int nesting_ = 0;
};

}  // namespace

bool is_constant_name(std::string_view name) {
  if (name.empty() || !is_letter(name[0]) || name == "x" || name == "y" || name == "z") return false;
  return std::all_of(name.begin(), name.end(), [](char c) { return is_letter(c) || is_digit(c) || c == '_'; });
}

Expression parse_expression(std::string_view text, const ExpressionConstants& constants) {
  return Parser(text, constants).run();
}

double evaluate(const Expression& expression, const DVec3& p) {
  return evaluate_tape<double>(expression.tape, p.x, p.y, p.z);
}

}  // namespace hemiray
