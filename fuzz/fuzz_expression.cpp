// libFuzzer target: any bytes as the expression of an implicit surface.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "host/scene/expression.hpp"

namespace {

void require(bool good) {
  if (!good) std::abort();
}

// What the kernels take for granted: the stack neither runs empty nor grows beyond what is said, one entry is left.
void check_tape(const hemiray::Expression& expression) {
  require(expression.degree >= 1 && expression.degree <= HR_MAX_DEGREE);
  require(!expression.tape.empty() && expression.tape.size() <= HR_TAPE_LENGTH);
  require(expression.stack <= HR_TAPE_STACK);
  std::size_t size = 0, most = 0;
  for (const hemiray::shared::uint4& op : expression.tape) {
    const bool pushes = op.x <= HR_TAPE_PUSH || op.x == HR_TAPE_DUP;
    const bool two = (op.x >= HR_TAPE_ADD && op.x <= HR_TAPE_MUL) || op.x >= HR_TAPE_MUL_UNDER;
    require(op.x < HR_TAPE_OP_COUNT);
    require(size >= (two ? 2U : (op.x <= HR_TAPE_PUSH ? 0U : 1U)));
    if (pushes) size++;
    if (two && op.x != HR_TAPE_MUL_UNDER) size--;
    most = size > most ? size : most;
  }
  require(size == 1 && most == expression.stack);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const hemiray::ExpressionConstants constants = {{"R", 1.0}, {"r", 0.25}, {"tau", 1.618033988749895}, {"w2", 4.0}};
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const hemiray::Expression expression = hemiray::parse_expression(text, constants);
    check_tape(expression);
    (void)hemiray::evaluate(expression, {0.5, -0.25, 2.0});
  } catch (const hemiray::ExpressionError& error) {
    require(error.column() >= 1 && error.column() <= text.size() + 1);
    require(std::string_view(error.what()).find('\n') == std::string_view::npos);
  }
  return 0;
}
