#include "solve/elastic_form.h"

#include "core/vector.h"

#include <algorithm>

namespace limber {
namespace {

// What storing a number in single precision changes of it, relatively, at most; and of a sum of
// products with numbers of double precision, with room for its own rounding.
constexpr double kFloatRounding = 6.0e-8;

}  // namespace

template <int K>
ElasticMemory<K>::ElasticMemory(const PoseModel& model)
    : columns(static_cast<size_t>(model.num_blocks) * K * kQuadLanes),
      active(model.num_blocks),
      blend(model.chunks() * kBlockLanes),
      product(model.chunks() * kBlockLanes * K * K),
      pulled(product),
      entries(blend) {}

template <int K>
ElasticForm<K>::ElasticForm(const PoseModel& model, const PinSet& pins,
                            const AlignedVector<double>& rotations, PatchTurns<K>* turns,
                            ElasticMemory<K>* memory)
    : model_(model),
      pins_(pins),
      rotations_(rotations),
      turns_(turns),
      memory_(*memory),
      kernels_(ChooseSolveKernels<K>()) {}

template <int K>
void ElasticForm<K>::TakeRotations() {
  for (size_t block = 0; block < static_cast<size_t>(model_.num_blocks); ++block) {
    double* columns = memory_.columns.data() + block * K * kQuadLanes;
    const double* planes = rotations_.data() + PlaneIndex<K>(block, 0, 0);
    for (size_t c = 0; c < K; ++c) {
      for (size_t a = 0; a < K; ++a)
        columns[a * kQuadLanes + c] = planes[(c * K + a) * kBlockLanes];
    }
  }
  memory_.has_active = memory_.has_product = false;
}

template <int K>
void ElasticForm<K>::Entries(int block, const int* others, size_t count, double* entries) {
  if (model_.is_folded) {
    const double* column = model_.GramColumn(block);
    for (size_t i = 0; i < count; ++i)
      entries[i] = column[others[i]];
    return;
  }
  const double* turn = memory_.columns.data() + static_cast<size_t>(block) * K * kQuadLanes;
  kernels_.turned_entries(model_.GramColumn(block), memory_.columns.data(), turn, others, count,
                          entries);
}

template <int K>
void ElasticForm<K>::Load(int block, double* load) {
  double rotation[K * K];
  for (size_t entry = 0; entry < size_t{K} * K; ++entry)
    rotation[entry] = rotations_[PlaneIndex<K>(static_cast<size_t>(block), entry / K, entry % K)];
  std::fill_n(load, num_rows(), 0.0);
  kernels_.add_turned_rows(rotation, pins_.BlockLoad(static_cast<size_t>(block)),
                           pins_.load_stride() / kQuadLanes, load);
  if (turns_ != nullptr) turns_->TakeFromLoad(pins_, static_cast<size_t>(block), 1, load);
}

template <int K>
void ElasticForm<K>::UseBlend(const double* blend) {
  const auto blocks = static_cast<size_t>(model_.num_blocks);
  if (memory_.has_active && std::equal(blend, blend + blocks, memory_.blend.begin())) return;
  std::copy_n(blend, blocks, memory_.blend.begin());
  memory_.active.Collect(memory_.blend, rotations_);
  memory_.has_active = true;
  memory_.has_product = false;
}

template <int K>
void ElasticForm<K>::Multiply(const double* blend) {
  UseBlend(blend);
  if (memory_.has_product || model_.is_folded) return;
  memory_.has_product = true;
  std::fill(memory_.product.begin(), memory_.product.end(), 0.0);
  kernels_.add_float_products(model_.gram_planes.data(), model_.planes_stride(),
                              memory_.active.blocks().data(), memory_.active.scaled(0),
                              memory_.active.size(), model_.chunks(), memory_.product.data());
}

// tr(R_i (P_i + V_i L residual)), or columns of Q where the rig is folded.
template <int K>
void ElasticForm<K>::Gradient(const double* blend, const double* residual, double* gradient,
                              double* errors) {
  Multiply(blend);
  if (model_.is_folded) {
    std::fill(memory_.pulled.begin(), memory_.pulled.end(), 0.0);
  } else {
    memory_.pulled = memory_.product;
  }
  kernels_.add_loads(pins_.loads.data(), residual, pins_.rank(), pins_.load_stride(),
                     model_.chunks(), memory_.pulled.data());
  if (turns_ != nullptr) turns_->TakeFromPulled(kernels_, pins_, residual, &memory_.pulled);
  kernels_.traces(rotations_.data(), memory_.pulled.data(), model_.chunks(), gradient);
  double size = 0;
  for (const int block : memory_.active.blocks()) {
    const auto i = static_cast<size_t>(block);
    if (model_.is_folded) {
      kernels_.add_scaled(blend[i], model_.GramColumn(block), model_.chunks(), gradient);
    } else {
      size += blend[i] * model_.gram_norms[i];
    }
  }
  const double error = kFloatRounding * K * size;
  for (size_t i = 0; i < static_cast<size_t>(model_.num_blocks); ++i)
    errors[i] = error * model_.gram_norms[i];
}

template <int K>
double ElasticForm<K>::HalfSquare() {
  const Vector<int>& blocks = memory_.active.blocks();
  double half = 0;
  for (size_t at = 0; at < blocks.size(); ++at) {
    Entries(blocks[at], blocks.data(), at + 1, memory_.entries.data());
    double sum = -0.5 * memory_.entries[at] * memory_.blend[static_cast<size_t>(blocks[at])];
    for (size_t other = 0; other <= at; ++other)
      sum += memory_.entries[other] * memory_.blend[static_cast<size_t>(blocks[other])];
    half += sum * memory_.blend[static_cast<size_t>(blocks[at])];
  }
  return half;
}

template <int K>
void ElasticForm<K>::TakeLoads(const ActiveBlocks<K>& active, double* rows) const {
  for (size_t at = 0; at < active.size(); ++at) {
    const auto block = static_cast<size_t>(active.blocks()[at]);
    double scaled[K * K];
    for (size_t entry = 0; entry < size_t{K} * K; ++entry)
      scaled[entry] = -active.scaled(at)[entry];
    kernels_.add_turned_rows(scaled, pins_.BlockLoad(block), pins_.load_stride() / kQuadLanes,
                             rows);
    if (turns_ != nullptr) turns_->TakeFromLoad(pins_, block, -active.weight(at), rows);
  }
}

template struct ElasticMemory<2>;
template struct ElasticMemory<3>;
template class ElasticForm<2>;
template class ElasticForm<3>;

}  // namespace limber
