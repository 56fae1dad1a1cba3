// FindNearestK by the 8-bit matrix products of tensor cores (mma.m16n8k32, compute capability 8.0).
//
// A warp keeps 32 queries in registers and passes over the whole set, 8 descriptors at a time: 8 products of
// 16 x 8 x 32 give 256 dot products, of which each lane holds 8. The products cost less than what follows them: a
// distance that is no nearer than the query's k-th nearest so far is dropped in registers, by two instructions; the
// others, about k ln(set / k) a query, are inserted by the four lanes that share the query, each of which keeps the
// whole list.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <cuda_runtime.h>

#include "victorious/kernels/k_nearest.h"
#include "victorious/kernels/nearest_device.h"

namespace victorious::kernels {
namespace {

constexpr unsigned kAllLanes = 0xFFFFFFFF;
constexpr unsigned kFirstOfEachFour = 0x11111111;  // lanes
constexpr int kWarps = 4;                          // a block
constexpr int kLanes = 32;
constexpr int kRowsPerWarp = 32;  // queries
constexpr int kRowsPerBlock = kWarps * kRowsPerWarp;
constexpr int kGroupColumns = 8;   // descriptors of one product
constexpr int kTileColumns = 128;  // descriptors in shared memory at a time
constexpr int kTileGroups = kTileColumns / kGroupColumns;
constexpr std::size_t kMaxDescriptors = std::size_t{1} << 24;  // of a call: an int counts their words
constexpr int kWordsPerRow = static_cast<int>(kDescriptorBytes) / 4;
constexpr int kGroupVectors = kGroupColumns * static_cast<int>(kDescriptorBytes) / 16;  // of 16 bytes
constexpr int kTileVectors = kTileGroups * kGroupVectors;
constexpr int kSteps = static_cast<int>(kDescriptorBytes) / 32;  // products over 32 bytes
constexpr int kBlockWords = static_cast<int>(kBlockBytes) / 4;

// c += a b with a: 16 x 32 signed bytes, b: 32 x 8 unsigned bytes, c: 16 x 8. Of lane l, with g = l / 4 and t = l % 4:
// a[0], a[1]: bytes 4t to 4t + 3 of rows g and g + 8; a[2], a[3]: the same from byte 16 on; b0, b1: the same of column
// g; c[0], c[1]: columns 2t and 2t + 1 of row g; c[2], c[3]: of row g + 8 (PTX ISA, "mma.m16n8k32").
__device__ void MultiplyAdd(int (&c)[4], const std::uint32_t (&a)[4], std::uint32_t b0, std::uint32_t b1) {
  asm volatile(
      "mma.sync.aligned.m16n8k32.row.col.s32.s8.u8.s32 {%0, %1, %2, %3}, {%4, %5, %6, %7}, {%8, %9}, {%0, %1, %2, %3};"
      : "+r"(c[0]), "+r"(c[1]), "+r"(c[2]), "+r"(c[3])
      : "r"(a[0]), "r"(a[1]), "r"(a[2]), "r"(a[3]), "r"(b0), "r"(b1));
}

__device__ void CopyAsync(void* shared, const void* global) {
  const auto address = static_cast<std::uint32_t>(__cvta_generic_to_shared(shared));
  asm volatile("cp.async.cg.shared.global [%0], [%1], 16;" ::"r"(address), "l"(global));
}

// Of one query; equal distances by rising index. All lanes that share the query hold the same.
template <int kMax>
struct NearestList {
  int distance[kMax];
  int index[kMax];

  __device__ void Clear() {
    for (int i = 0; i < kMax; ++i) {
      distance[i] = kPaddingDistance;
      index[i] = -1;
    }
  }

  __device__ int Worst() const { return distance[kMax - 1]; }

  __device__ void Insert(int new_distance, int new_index) {
    bool is_before[kMax];
#pragma unroll
    for (int i = 0; i < kMax; ++i) {
      is_before[i] = new_distance < distance[i] || (new_distance == distance[i] && new_index < index[i]);
    }
#pragma unroll
    for (int i = kMax - 1; i > 0; --i) {
      distance[i] = is_before[i - 1] ? distance[i - 1] : is_before[i] ? new_distance : distance[i];
      index[i] = is_before[i - 1] ? index[i - 1] : is_before[i] ? new_index : index[i];
    }
    distance[0] = is_before[0] ? new_distance : distance[0];
    index[0] = is_before[0] ? new_index : index[0];
  }
};

// Reorders a packed set (blocks.h) so that each lane reads what it multiplies as two vectors of 16 bytes: of group j,
// half h of the steps and lane l the vector 64 j + 32 h + l.
__global__ void ReorderKernel(const std::uint32_t* blocks, int columns, std::uint32_t* reordered, int padded_columns) {
  const int word = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (word >= padded_columns * kWordsPerRow) return;
  const int column = word / kWordsPerRow;
  const int k = word % kWordsPerRow;  // of the descriptor
  const int step = k / 8;
  const int lane = column % kGroupColumns * 4 + k % 4;
  const int place = (column / kGroupColumns * 64 + step / 2 * kLanes + lane) * 4 + step % 2 * 2 + k / 4 % 2;
  const int per_block = static_cast<int>(kBlockDescriptors);
  reordered[place] =
      column < columns ? blocks[column / per_block * kBlockWords + k * per_block + column % per_block] : 0;
}

template <int kMax>
__global__ void __launch_bounds__(kWarps* kLanes)
    FindNearestKernel(const std::uint32_t* queries, const int* squared, int query_count, const uint4* set,
                      const int* constant, int tiles, int k, Neighbour* out) {
  __shared__ uint4 vectors[2][kTileVectors];
  __shared__ __align__(16) int constants[2][kTileColumns];
  const int lane = static_cast<int>(threadIdx.x) % kLanes;
  const int group = lane / 4;
  const int quarter = lane % 4;
  const int first_row =
      static_cast<int>(blockIdx.x) * kRowsPerBlock + static_cast<int>(threadIdx.x) / kLanes * kRowsPerWarp;
  // Of this lane's row r, 0 to 3.
  const auto row_of = [&](int r) { return first_row + r * 8 + group; };

  std::uint32_t a[2][kSteps][4];
#pragma unroll
  for (int m = 0; m < 2; ++m) {
#pragma unroll
    for (int i = 0; i < 4; ++i) {
      const int row = min(row_of(2 * m + i % 2), query_count - 1);
#pragma unroll
      for (int step = 0; step < kSteps; ++step) {
        a[m][step][i] = queries[static_cast<std::size_t>(row) * kWordsPerRow + step * 8 + i / 2 * 4 + quarter];
      }
    }
  }
  NearestList<kMax> nearest[4];
  for (NearestList<kMax>& one : nearest) one.Clear();

  const auto load = [&](int tile) {
    for (int i = static_cast<int>(threadIdx.x); i < kTileVectors; i += kWarps * kLanes) {
      CopyAsync(&vectors[tile % 2][i], set + static_cast<std::size_t>(tile) * kTileVectors + i);
    }
    if (threadIdx.x < kTileColumns / 4) {
      CopyAsync(&constants[tile % 2][threadIdx.x * 4], constant + tile * kTileColumns + threadIdx.x * 4);
    }
    asm volatile("cp.async.commit_group;");
  };
  load(0);
  for (int tile = 0; tile < tiles; ++tile) {
    if (tile + 1 < tiles) {
      load(tile + 1);
      asm volatile("cp.async.wait_group 1;");
    } else {
      asm volatile("cp.async.wait_group 0;");
    }
    __syncthreads();
#pragma unroll 1
    for (int j = 0; j < kTileGroups; ++j) {
      const uint4 low = vectors[tile % 2][j * kGroupVectors + lane];
      const uint4 high = vectors[tile % 2][j * kGroupVectors + kLanes + lane];
      const int2 column_constants =
          *reinterpret_cast<const int2*>(&constants[tile % 2][j * kGroupColumns + 2 * quarter]);
      int distance[4][2];
      bool is_near = false;
#pragma unroll
      for (int m = 0; m < 2; ++m) {
        int products[4] = {};
        MultiplyAdd(products, a[m][0], low.x, low.y);
        MultiplyAdd(products, a[m][1], low.z, low.w);
        MultiplyAdd(products, a[m][2], high.x, high.y);
        MultiplyAdd(products, a[m][3], high.z, high.w);
#pragma unroll
        for (int half = 0; half < 2; ++half) {
          const int r = 2 * m + half;
          distance[r][0] = column_constants.x - 2 * products[2 * half];
          distance[r][1] = column_constants.y - 2 * products[2 * half + 1];
          is_near = is_near || min(distance[r][0], distance[r][1]) <= nearest[r].Worst();
        }
      }
      if (!__any_sync(kAllLanes, is_near)) continue;
      const int first_column = tile * kTileColumns + j * kGroupColumns;
#pragma unroll
      for (int r = 0; r < 4; ++r) {
#pragma unroll
        for (int odd = 0; odd < 2; ++odd) {
          // Equal distances, too: the four lanes' columns do not rise from one to the next insertion.
          const unsigned near_lanes = __ballot_sync(kAllLanes, distance[r][odd] <= nearest[r].Worst());
#pragma unroll
          for (int source = 0; source < 4; ++source) {  // of the four, mostly one for all eight queries together
            if ((near_lanes & (kFirstOfEachFour << source)) == 0) continue;
            nearest[r].Insert(__shfl_sync(kAllLanes, distance[r][odd], source, 4), first_column + 2 * source + odd);
          }
        }
      }
    }
    __syncthreads();
  }
#pragma unroll
  for (int r = 0; r < 4; ++r) {
    const int row = row_of(r);
    if (row >= query_count) continue;
#pragma unroll
    for (int i = 0; i < kMax; ++i) {
      if (i % 4 != quarter || i >= k) continue;
      Neighbour one;
      if (nearest[r].distance[i] < kPaddingDistance) {
        one.index = static_cast<std::uint32_t>(nearest[r].index[i]);
        one.distance2 = static_cast<std::uint32_t>(nearest[r].distance[i] + squared[row]);
      }
      out[static_cast<std::size_t>(row) * k + i] = one;
    }
  }
}

// From the device's pool: taken and given back without waiting for other streams. What uses it first is in `stream`;
// other streams must wait until that is done.
struct DeviceMemory {
  static cudaError_t Allocate(void** data, std::size_t bytes, cudaStream_t stream) {
    return cudaMallocAsync(data, bytes, stream);
  }
  static void Free(void* data) { cudaFreeAsync(data, nullptr); }
};

// Of the host, which the device copies from and to.
struct HostMemory {
  static cudaError_t Allocate(void** data, std::size_t bytes, cudaStream_t) { return cudaMallocHost(data, bytes); }
  static void Free(void* data) { cudaFreeHost(data); }
};

// Grows, never shrinks.
template <typename Memory>
class Buffer {
 public:
  Buffer() = default;
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  ~Buffer() { Free(); }

  [[nodiscard]] cudaError_t Reserve(std::size_t bytes, cudaStream_t stream) {
    if (bytes <= capacity_) return cudaSuccess;
    Free();
    const cudaError_t error = Memory::Allocate(&data_, bytes, stream);
    capacity_ = error == cudaSuccess ? bytes : 0;
    return error;
  }

  template <typename T>
  [[nodiscard]] T* As() const {
    return static_cast<T*>(data_);
  }

 private:
  void Free() {
    if (capacity_ != 0) Memory::Free(data_);
    capacity_ = 0;
  }

  void* data_ = nullptr;
  std::size_t capacity_ = 0;
};
using DeviceBuffer = Buffer<DeviceMemory>;
using HostBuffer = Buffer<HostMemory>;

struct CudaSet : DeviceSet {
  DeviceBuffer vectors;
  DeviceBuffer constants;
  int tiles = 0;
};

struct CudaQueries : DeviceQueries {
  DeviceBuffer rows;
  DeviceBuffer squared;
  int count = 0;
};

// What one call needs: calls of several threads have one each.
struct CallResources {
  cudaStream_t stream = nullptr;
  HostBuffer host;
  DeviceBuffer device;

  ~CallResources() {
    if (stream == nullptr) return;
    cudaStreamSynchronize(stream);  // a call that failed may have left copies under way
    cudaStreamDestroy(stream);
  }
};

class CudaNearestDevice final : public NearestDevice {
 public:
  explicit CudaNearestDevice(std::string name) : name_(std::move(name)) {}

  [[nodiscard]] std::string_view name() const override { return name_; }

  [[nodiscard]] std::size_t failed_calls() const override {
    const std::scoped_lock lock(mutex_);
    return failed_calls_;
  }

  [[nodiscard]] std::string last_error() const override {
    const std::scoped_lock lock(mutex_);
    return last_error_;
  }

  [[nodiscard]] std::unique_ptr<const DeviceSet> Upload(const PackedDescriptors& set) override {
    auto made = std::make_unique<CudaSet>();
    return Call([&](CallResources& call) { return UploadSet(set, call, *made); }) ? std::move(made) : nullptr;
  }

  [[nodiscard]] std::unique_ptr<const DeviceQueries> Upload(std::span<const PackedQueries> templates) override {
    auto made = std::make_unique<CudaQueries>();
    return Call([&](CallResources& call) { return UploadQueries(templates, call, *made); }) ? std::move(made) : nullptr;
  }

  [[nodiscard]] bool FindNearestK(const DeviceQueries& queries, const DeviceSet& set, std::size_t k,
                                  std::span<Neighbour> out) override {
    return Call([&](CallResources& call) {
      return Find(static_cast<const CudaQueries&>(queries), static_cast<const CudaSet&>(set), static_cast<int>(k), out,
                  call);
    });
  }

 private:
  // Runs `use` with resources of its own; false if it fails.
  template <typename Use>
  bool Call(const Use& use) {
    std::unique_ptr<CallResources> call;
    {
      const std::scoped_lock lock(mutex_);
      if (!idle_.empty()) {
        call = std::move(idle_.back());
        idle_.pop_back();
      }
    }
    cudaError_t error = cudaSetDevice(0);  // of this thread
    if (!call) call = std::make_unique<CallResources>();
    if (error == cudaSuccess && call->stream == nullptr) {
      error = cudaStreamCreateWithFlags(&call->stream, cudaStreamNonBlocking);
    }
    if (error == cudaSuccess) error = use(*call);
    if (error != cudaSuccess) {
      cudaGetLastError();  // else the next launch of this thread would return it
      call.reset();
    }
    const std::scoped_lock lock(mutex_);
    if (call) {
      idle_.push_back(std::move(call));
    } else {
      ++failed_calls_;
      last_error_ = cudaGetErrorString(error);
    }
    return error == cudaSuccess;
  }

  static cudaError_t UploadSet(const PackedDescriptors& set, CallResources& call, CudaSet& made) {
    if (set.count > kMaxDescriptors) return cudaErrorInvalidValue;
    made.tiles = static_cast<int>((set.count + kTileColumns - 1) / kTileColumns);
    if (made.tiles == 0) return cudaSuccess;
    const int padded = made.tiles * kTileColumns;
    const std::size_t constant_bytes = static_cast<std::size_t>(padded) * sizeof(int);
    cudaError_t error = call.host.Reserve(set.blocks.size() + constant_bytes, call.stream);
    if (error == cudaSuccess) error = call.device.Reserve(set.blocks.size(), call.stream);
    if (error == cudaSuccess) {
      error = made.vectors.Reserve(static_cast<std::size_t>(padded) * kDescriptorBytes, call.stream);
    }
    if (error == cudaSuccess) error = made.constants.Reserve(constant_bytes, call.stream);
    if (error != cudaSuccess) return error;
    int* const constants = call.host.As<int>();
    std::copy(set.constant.begin(), set.constant.end(), constants);
    std::fill(constants + set.constant.size(), constants + padded, kPaddingDistance);
    std::uint8_t* const blocks = call.host.As<std::uint8_t>() + constant_bytes;
    std::copy(set.blocks.begin(), set.blocks.end(), blocks);
    error = cudaMemcpyAsync(made.constants.As<int>(), constants, constant_bytes, cudaMemcpyHostToDevice, call.stream);
    if (error != cudaSuccess) return error;
    error =
        cudaMemcpyAsync(call.device.As<std::uint8_t>(), blocks, set.blocks.size(), cudaMemcpyHostToDevice, call.stream);
    if (error != cudaSuccess) return error;
    constexpr int kThreads = 256;
    const int words = padded * kWordsPerRow;
    ReorderKernel<<<(words + kThreads - 1) / kThreads, kThreads, 0, call.stream>>>(
        call.device.As<std::uint32_t>(), static_cast<int>(set.count), made.vectors.As<std::uint32_t>(), padded);
    error = cudaGetLastError();
    return error == cudaSuccess ? cudaStreamSynchronize(call.stream) : error;
  }

  static cudaError_t UploadQueries(std::span<const PackedQueries> templates, CallResources& call, CudaQueries& made) {
    std::size_t count = 0;
    for (const PackedQueries& one : templates) count += one.count;
    if (count > kMaxDescriptors) return cudaErrorInvalidValue;
    made.count = static_cast<int>(count);
    if (count == 0) return cudaSuccess;
    const std::size_t row_bytes = count * kDescriptorBytes;
    const std::size_t squared_bytes = count * sizeof(int);
    cudaError_t error = call.host.Reserve(row_bytes + squared_bytes, call.stream);
    if (error == cudaSuccess) error = made.rows.Reserve(row_bytes, call.stream);
    if (error == cudaSuccess) error = made.squared.Reserve(squared_bytes, call.stream);
    if (error != cudaSuccess) return error;
    std::int8_t* row = call.host.As<std::int8_t>();
    std::int32_t* squared = reinterpret_cast<std::int32_t*>(row + row_bytes);
    for (const PackedQueries& one : templates) {
      row = std::copy(one.rows.begin(), one.rows.end(), row);
      squared = std::copy(one.squared.begin(), one.squared.end(), squared);
    }
    const std::uint8_t* const host = call.host.As<std::uint8_t>();
    error = cudaMemcpyAsync(made.rows.As<void>(), host, row_bytes, cudaMemcpyHostToDevice, call.stream);
    if (error != cudaSuccess) return error;
    error =
        cudaMemcpyAsync(made.squared.As<void>(), host + row_bytes, squared_bytes, cudaMemcpyHostToDevice, call.stream);
    return error == cudaSuccess ? cudaStreamSynchronize(call.stream) : error;
  }

  static cudaError_t Find(const CudaQueries& queries, const CudaSet& set, int k, std::span<Neighbour> out,
                          CallResources& call) {
    if (queries.count == 0 || set.tiles == 0) {
      std::ranges::fill(out, Neighbour{});
      return cudaSuccess;
    }
    const std::size_t bytes = static_cast<std::size_t>(queries.count) * k * sizeof(Neighbour);
    cudaError_t error = call.device.Reserve(bytes, call.stream);
    if (error == cudaSuccess && !out.empty()) error = call.host.Reserve(bytes, call.stream);
    if (error != cudaSuccess) return error;
    constexpr int kFew = 4;
    const int blocks = (queries.count + kRowsPerBlock - 1) / kRowsPerBlock;
    const auto kernel = k <= kFew ? &FindNearestKernel<kFew> : &FindNearestKernel<static_cast<int>(kMaxNeighbours)>;
    kernel<<<blocks, kWarps * kLanes, 0, call.stream>>>(queries.rows.As<std::uint32_t>(), queries.squared.As<int>(),
                                                        queries.count, set.vectors.As<uint4>(), set.constants.As<int>(),
                                                        set.tiles, k, call.device.As<Neighbour>());
    error = cudaGetLastError();
    if (error == cudaSuccess && !out.empty()) {
      error = cudaMemcpyAsync(call.host.As<void>(), call.device.As<void>(), bytes, cudaMemcpyDeviceToHost, call.stream);
    }
    if (error == cudaSuccess) error = cudaStreamSynchronize(call.stream);
    if (error == cudaSuccess && !out.empty()) std::memcpy(out.data(), call.host.As<void>(), bytes);
    return error;
  }

  std::string name_;
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<CallResources>> idle_;
  std::size_t failed_calls_ = 0;
  std::string last_error_;
};

// Lets the first device keep what is freed, for the next call.
cudaError_t KeepFreedMemory() {
  cudaMemPool_t pool = nullptr;
  const cudaError_t error = cudaDeviceGetDefaultMemPool(&pool, 0);
  if (error != cudaSuccess) return error;
  std::uint64_t all = UINT64_MAX;
  return cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &all);
}

}  // namespace

std::shared_ptr<NearestDevice> OpenNearestDevice(std::string& why_not) {
  int count = 0;
  cudaError_t error = cudaGetDeviceCount(&count);
  cudaDeviceProp properties{};
  if (error == cudaSuccess && count > 0) error = cudaGetDeviceProperties(&properties, 0);
  if (error != cudaSuccess || count == 0) {
    why_not = "no CUDA device here";
    if (error != cudaSuccess) why_not += std::string(" (") + cudaGetErrorString(error) + ")";
    return nullptr;
  }
  constexpr int kMinMajor = 8;
  if (properties.major < kMinMajor) {
    why_not = std::string(properties.name) + " has a compute capability below 8.0";
    return nullptr;
  }
  error = KeepFreedMemory();
  if (error != cudaSuccess) {
    why_not = std::string(properties.name) + " has no pool of memory (" + cudaGetErrorString(error) + ")";
    return nullptr;
  }
  return std::make_shared<CudaNearestDevice>(properties.name);
}

}  // namespace victorious::kernels
