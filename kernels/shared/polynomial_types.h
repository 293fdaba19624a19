// An implicit polynomial surface f(x, y, z) = 0 as a tape: the expression's tree in postfix order, never expanded into
// monomials, whose sum would lose the digits of a high degree before any root is sought.
#ifndef HR_SHARED_POLYNOMIAL_TYPES_H
#define HR_SHARED_POLYNOMIAL_TYPES_H

#include "shared/scalar.h"

#define HR_MAX_DEGREE 16
#define HR_TAPE_STACK 6    /* polynomials of up to 17 coefficients that wait at once */
#define HR_TAPE_LENGTH 512 /* instructions of one surface */

// An instruction is a uint4: x = what it does; z, w = its constant as the bits of two floats whose sum it is, which
// double keeps exactly and float-float too. "Top" and "under" are the last two of the stack.
#define HR_TAPE_X 0u /* push a coordinate */
#define HR_TAPE_Y 1u
#define HR_TAPE_Z 2u
#define HR_TAPE_PUSH 3u /* push the constant */
#define HR_TAPE_ADD 4u  /* under + top, in place of both; likewise the next three */
#define HR_TAPE_SUB 5u  /* under - top */
#define HR_TAPE_RSUB 6u /* top - under */
#define HR_TAPE_MUL 7u  /* under * top */
#define HR_TAPE_NEG 8u  /* -top */
#define HR_TAPE_SQR 9u  /* top^2 */
#define HR_TAPE_ADD_CONST 10u
#define HR_TAPE_MUL_CONST 11u
#define HR_TAPE_DUP 12u       /* push top once more */
#define HR_TAPE_MUL_UNDER 13u /* top * under in place of top; under stays */
#define HR_TAPE_NIP 14u       /* remove under */
#define HR_TAPE_OP_COUNT 15u

#endif
