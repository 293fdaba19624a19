// Polynomials as text: values, degrees, the shape of the tape, and what errors say and where.
#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <random>
#include <string>

#include "host/scene/expression.hpp"

namespace hemiray {
namespace {

const ExpressionConstants kConstants = {{"R", 1.0}, {"r", 0.25}, {"tau", 1.618033988749895}, {"big", 1e20}};

std::string fault_of(const std::string& text) {
  try {
    (void)parse_expression(text, kConstants);
  } catch (const ExpressionError& error) {
    return error.what();
  }
  return "none";
}

double value_of(const std::string& text, const DVec3& p) { return evaluate(parse_expression(text, kConstants), p); }

}  // namespace

TEST_CASE("an expression has the value it would have in C++") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-2.0, 2.0);
  for (int i = 0; i < 100; i++) {
    const double x = uniform(random), y = uniform(random), z = uniform(random);
    const DVec3 p(x, y, z);
    // Constants of the tape have 48 bits.
    const auto near = [](double expected) { return Approx(expected).epsilon(1e-13).margin(1e-12); };
    CHECK(value_of("x", p) == x);
    CHECK(value_of("-x^2+1", p) == -(x * x) + 1);
    CHECK(value_of("x - y - z", p) == x - y - z);
    CHECK(value_of("x - (y*z + z^2*x)", p) == near(x - (y * z + z * z * x)));
    CHECK(value_of("1 - x", p) == -x + 1);
    CHECK(value_of(" x / 2 /4*y ", p) == near(x / 8 * y));
    CHECK(value_of("2^3*x + 1.5e-1 - R/r", p) == near(8 * x + 0.15 - 4));
    CHECK(value_of("--x*-+y", p) == -(x * y));
    const double sum = x * x + y * y + z * z + 1.0 - 0.0625;
    CHECK(value_of("(x^2+y^2+z^2+R^2-r^2)^2 - 4*R^2*(x^2+y^2)", p) == near(sum * sum - 4 * (x * x + y * y)));
    for (int n = 1; n <= 16; n++) {
      CHECK(value_of("(x+y)^" + std::to_string(n) + "+1", p) == Approx(std::pow(x + y, n) + 1).epsilon(1e-13));
    }
  }
}

TEST_CASE("degree, stack and length of an expression are those of its tree") {
  const auto degree = [](const std::string& text) { return parse_expression(text, kConstants).degree; };
  CHECK(degree("x") == 1);
  CHECK(degree("x*y*z - 1") == 3);
  CHECK(degree("(x^2+y)^8-1") == 16);
  CHECK(degree("0*x^16 + y") == 1);
  CHECK(degree("x^0*y") == 1);
  // The deeper part comes first, so a long chain needs two entries whichever way it is written.
  CHECK(parse_expression("x+(y+(z+(x+(y+(z+(x+y))))))", kConstants).stack == 2);
  CHECK(parse_expression("((((x+y)*z)+x)*y)-z", kConstants).stack == 2);
  const Expression swapped = parse_expression("x - y*z", kConstants);
  REQUIRE(swapped.tape.size() == 5);
  CHECK(swapped.tape[4].x == HR_TAPE_RSUB);
  const Expression square = parse_expression("(x+1)^8+1", kConstants);
  CHECK(square.tape.size() == 6);
  const shared::uint4 third = parse_expression("x/3", kConstants).tape[1];
  CHECK(third.x == HR_TAPE_MUL_CONST);
  CHECK(double{std::bit_cast<float>(third.z)} + double{std::bit_cast<float>(third.w)} ==
        Approx(1.0 / 3.0).epsilon(1e-14));
}

TEST_CASE("factors that the text repeats count once") {
  const auto parsed = [](const std::string& text) { return parse_expression(text, kConstants); };
  const auto check_same = [&](const std::string& text, const std::string& expected, std::uint32_t written) {
    INFO(text);
    const Expression a = parsed(text), b = parsed(expected);
    CHECK(a.degree == b.degree);
    CHECK(a.written_degree == written);
    REQUIRE(a.tape.size() == b.tape.size());
    for (std::size_t i = 0; i < a.tape.size(); i++) {
      CHECK((a.tape[i].x == b.tape[i].x && a.tape[i].z == b.tape[i].z && a.tape[i].w == b.tape[i].w));
    }
  };
  check_same("(x^2+y^2+z^2-R)^2", "x^2+y^2+z^2-R", 4);
  check_same("3*(x+y)^3", "x+y", 3);
  check_same("-(x+y)^3/2", "-(x+y)", 3);
  check_same("(x*(y-1))^2*x", "x*(y-1)", 5);
  check_same("(x-y)*z*(x-y)", "(x-y)*z", 3);
  // Not what is no factor of the whole, and not what only algebra would find.
  check_same("x^2*y^2+z^2", "x^2*y^2+z^2", 4);
  check_same("(x-y)*(y-x)", "(x-y)*(y-x)", 2);
}

TEST_CASE("an error names the column and what was expected") {
  CHECK(fault_of("") == "column 1: expected a number, a name or an opening parenthesis, found the end");
  CHECK(fault_of("x +") == "column 4: expected a number, a name or an opening parenthesis, found the end");
  CHECK(fault_of("x + * y") == "column 5: expected a number, a name or an opening parenthesis, found \"*\"");
  CHECK(fault_of("2x") == "column 2: expected an operator, found \"x\"");
  CHECK(fault_of("(x+y") == "column 5: expected an operator or a closing parenthesis, found the end");
  CHECK(fault_of("x+y)") == "column 4: this parenthesis closes none");
  CHECK(fault_of("x^-1") == "column 3: expected an exponent, a whole number, found \"-\"");
  CHECK(fault_of("x^y") == "column 3: expected an exponent, a whole number, found \"y\"");
  CHECK(fault_of("x^2.5") == "column 4: an exponent is a whole number without a point");
  CHECK(fault_of("x^17") == "column 3: an exponent is at most 16");
  CHECK(fault_of("x^99999999999999999999") == "column 3: an exponent is at most 16");
  CHECK(fault_of("x^2^3") == "column 4: a power of a power needs parentheses");
  CHECK(fault_of("x^9*y^8") == "column 4: the degree is 17 here, and may be at most 16");
  CHECK(fault_of("(x^4)^5") == "column 6: the degree is 20 here, and may be at most 16");
  CHECK(fault_of("1/x") == "column 3: only division by constants gives a polynomial");
  CHECK(fault_of("x/(r-r)") == "column 3: division by zero");
  CHECK(fault_of("R^2 - 4*r") == "column 1: the expression does not depend on x, y or z");
  CHECK(fault_of("x + 0*y - x*0 + tua") ==
        "column 17: \"tua\" is neither x, y, z nor one of the constants; did you mean \"tau\"?");
  CHECK(fault_of("x*big*big") == "none");  // each constant by itself
  CHECK(fault_of("x*(big*big)") == "column 7: the constant 1e+40 is neither 0 nor between 1e-30 and 1e+30");
  CHECK(fault_of("x*1e999") == "column 3: this number is too large or too small");
  CHECK(fault_of("x*.") == "column 3: expected a number, found \".\"");
  CHECK(fault_of("x\1") == "column 2: expected an operator, found \"\\x01\"");
  CHECK(fault_of("x\u00b2 + 1") == "column 2: expected an operator, found \"\u00b2\"");
}

TEST_CASE("what would not fit the kernels is refused, and says what") {
  std::string tree = "x*y";  // a full binary tree needs one entry more a level
  for (int level = 0; level < 5; level++) tree = "(" + tree + ")+(" + tree + ")";
  CHECK(fault_of(tree).find("column 1: nested too deeply: 7 parts wait for each other, at most 6 can") == 0);
  std::string open = std::string(200, '(') + "x" + std::string(200, ')');
  CHECK(fault_of(open).find("more than 100 parentheses and signs are open") != std::string::npos);
  CHECK(fault_of(std::string(100000, '-')).find("at most 4096 bytes") != std::string::npos);
  CHECK(fault_of(std::string(4000, '-')).find("more than 100 parentheses and signs are open") != std::string::npos);
  std::string sum = "x";
  for (int i = 0; i < 300; i++) sum += "+y*z";
  CHECK(fault_of(sum).find("the expression needs more than 512 instructions") != std::string::npos);
}

TEST_CASE("names of constants") {
  CHECK(is_constant_name("R"));
  CHECK(is_constant_name("w_0"));
  for (const char* name : {"", "x", "y", "z", "2r", "_a", "a b", "a-b"}) CHECK_FALSE(is_constant_name(name));
}

}  // namespace hemiray
