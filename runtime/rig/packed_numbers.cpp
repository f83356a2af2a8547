#include "rig/packed_numbers.h"

#include "core/vector.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace limber {
namespace {

constexpr size_t kBlock = 16;
constexpr unsigned kParameterBits = 5;
constexpr unsigned kAllZero = 31;
constexpr unsigned kMostParameter = 30;
constexpr uint64_t kMostFolded = uint64_t{1} << 31;  // u of the largest integer

class BitWriter {
 public:
  // The lowest `count` bits of `bits`, at most 32; those above are zero.
  void Put(uint64_t bits, unsigned count) {
    waiting_ |= bits << num_waiting_;
    num_waiting_ += count;
    for (; num_waiting_ >= 8; num_waiting_ -= 8, waiting_ >>= 8)
      bytes_.push_back(static_cast<uint8_t>(waiting_));
  }

  void PutUnary(uint64_t number) {
    for (; number >= 31; number -= 31)
      Put(0x7fffffff, 31);
    Put((uint64_t{1} << number) - 1, static_cast<unsigned>(number) + 1);
  }

  Vector<uint8_t> Finish() {
    if (num_waiting_ > 0) bytes_.push_back(static_cast<uint8_t>(waiting_));
    return std::move(bytes_);
  }

 private:
  Vector<uint8_t> bytes_;
  uint64_t waiting_ = 0;
  unsigned num_waiting_ = 0;
};

class BitReader {
 public:
  explicit BitReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  // `count` bits, at most 32. Beyond the end: zeros, and failed().
  uint64_t Take(unsigned count) {
    while (num_waiting_ < count)
      Refill();
    const uint64_t bits = waiting_ & ((uint64_t{1} << count) - 1);
    waiting_ >>= count;
    num_waiting_ -= count;
    return bits;
  }

  // A number of ones and the zero after them; more than `most` ones is a failure.
  uint64_t TakeUnary(uint64_t most) {
    uint64_t ones = 0;
    while (!failed_ && ones <= most) {
      if (num_waiting_ == 0) Refill();
      const auto run = std::min(static_cast<unsigned>(std::countr_one(waiting_)), num_waiting_);
      const bool ended = run < num_waiting_;
      Take(run);
      ones += run;
      if (!ended) continue;
      Take(1);
      break;
    }
    if (ones > most) Fail();
    return ones;
  }

  void Fail() { failed_ = true; }

  bool failed() const { return failed_; }

  // Whether what is left are only the zero bits that fill the last byte.
  bool AtEnd() const { return at_ == bytes_.size() && num_waiting_ < 8 && waiting_ == 0; }

 private:
  void Refill() {
    if (at_ < bytes_.size()) {
      waiting_ |= uint64_t{bytes_[at_++]} << num_waiting_;
    } else {
      Fail();
    }
    num_waiting_ += 8;
  }

  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
  uint64_t waiting_ = 0;
  unsigned num_waiting_ = 0;
  bool failed_ = false;
};

uint64_t Fold(int64_t integer) {
  return integer >= 0 ? static_cast<uint64_t>(integer) * 2
                      : static_cast<uint64_t>(-integer) * 2 - 1;
}

int64_t Unfold(uint64_t folded) {
  return folded % 2 == 0 ? static_cast<int64_t>(folded / 2) : -static_cast<int64_t>(folded / 2) - 1;
}

// The parameter with which the block is shortest, the least of several.
unsigned BestParameter(std::span<const uint64_t> folded) {
  unsigned best = 0;
  uint64_t fewest = UINT64_MAX;
  for (unsigned r = 0; r <= kMostParameter; ++r) {
    uint64_t bits = 0;
    for (const uint64_t u : folded)
      bits += (u >> r) + 1 + r;
    if (bits >= fewest) continue;
    fewest = bits;
    best = r;
  }
  return best;
}

void PutBlock(std::span<const uint64_t> folded, BitWriter* writer) {
  if (std::all_of(folded.begin(), folded.end(), [](uint64_t u) { return u == 0; })) {
    writer->Put(kAllZero, kParameterBits);
    return;
  }
  const unsigned r = BestParameter(folded);
  writer->Put(r, kParameterBits);
  for (const uint64_t u : folded) {
    writer->PutUnary(u >> r);
    writer->Put(u & ((uint64_t{1} << r) - 1), r);
  }
}

void TakeBlock(BitReader* reader, double step, std::span<float> numbers) {
  const auto r = static_cast<unsigned>(reader->Take(kParameterBits));
  if (r == kAllZero) return;
  for (float& number : numbers) {
    const uint64_t high = reader->TakeUnary(kMostFolded >> r);
    const uint64_t folded = high << r | reader->Take(r);
    number = static_cast<float>(static_cast<double>(Unfold(folded)) * step);
    if (!std::isfinite(number)) reader->Fail();
  }
}

}  // namespace

int PackingExponent(std::span<const float> numbers, int bits) {
  float largest = 0;
  for (const float number : numbers)
    largest = std::max(largest, std::abs(number));
  if (!(largest > 0)) return 0;
  int above = 0;  // largest < 2^above
  std::frexp(largest, &above);
  return std::clamp(above - bits, kLeastPackingExponent, kMostPackingExponent);
}

Vector<uint8_t> PackNumbers(std::span<const float> numbers, int exponent) {
  BitWriter writer;
  Vector<uint64_t> folded;
  for (size_t first = 0; first < numbers.size(); first += kBlock) {
    folded.clear();
    for (const float number : numbers.subspan(first, std::min(kBlock, numbers.size() - first)))
      folded.push_back(Fold(std::llround(std::ldexp(static_cast<double>(number), -exponent))));
    PutBlock(folded, &writer);
  }
  return writer.Finish();
}

Result<Vector<float>> UnpackNumbers(std::span<const uint8_t> bytes, size_t count, int exponent) {
  if (exponent < kLeastPackingExponent || exponent > kMostPackingExponent) {
    return Error(StatusCode::kMalformed, "exponent %d is not within %d to %d", exponent,
                 kLeastPackingExponent, kMostPackingExponent);
  }
  const size_t num_blocks = count / kBlock + (count % kBlock != 0 ? 1 : 0);
  if (num_blocks > bytes.size() * 8 / kParameterBits) {
    return Error(StatusCode::kMalformed, "%zu packed bytes cannot hold %zu numbers", bytes.size(),
                 count);
  }
  const double step = std::ldexp(1.0, exponent);
  Vector<float> numbers(count);
  BitReader reader(bytes);
  for (size_t first = 0; first < count && !reader.failed(); first += kBlock) {
    TakeBlock(&reader, step, std::span(numbers).subspan(first, std::min(kBlock, count - first)));
  }
  if (reader.failed()) {
    return Error(StatusCode::kMalformed,
                 "%zu packed bytes end before %zu numbers, or one is out of range", bytes.size(),
                 count);
  }
  if (reader.AtEnd()) return numbers;
  return Error(StatusCode::kMalformed, "%zu numbers end before the %zu packed bytes", count,
               bytes.size());
}

}  // namespace limber
