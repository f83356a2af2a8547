// Tables of a baked file, packed: multiples of a power of two in Rice's code.
//
// The numbers follow one another in blocks of 16 (the last may have fewer), all of them one stream
// of bits, the lowest bit of each byte first, filled up with zero bits to whole bytes. A block is
// five bits, r, then its integers: i >= 0 as u = 2 i, i < 0 as u = -2 i - 1; of u first u >> r in
// unary (that many ones and a zero), then its r lowest bits. r = 31 says that all of the block is
// zero, and nothing follows. Integer i stands for i * 2^exponent.
//
// So the error is the same anywhere in a table, which is what sums of squares ask for, and zeros
// and small numbers cost little.
#pragma once

#include "core/status.h"
#include "core/vector.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace limber {

inline constexpr int kLeastPackingExponent = -126;
inline constexpr int kMostPackingExponent = 104;

// The exponent with which the largest of `numbers` takes `bits` bits beside its sign (2 to 30): the
// error is then at most 2^-bits of it. Whole numbers of up to 24 bits come back as they are if
// their own exponent is 0.
int PackingExponent(std::span<const float> numbers, int bits);

// Finite numbers, each rounded to the nearest multiple; exponent as PackingExponent gives it, or
// such that no integer exceeds 30 bits.
Vector<uint8_t> PackNumbers(std::span<const float> numbers, int exponent);

// `count` numbers, exactly as many as the bytes hold. Errors: kMalformed (bytes missing or left
// over, an integer, a number or the exponent out of range); nothing of more than 100 times the
// bytes is allocated.
Result<Vector<float>> UnpackNumbers(std::span<const uint8_t> bytes, size_t count, int exponent);

}  // namespace limber
