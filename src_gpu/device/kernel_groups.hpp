// The kernels' groups of arguments on the host, and kernels that take them, from the lists of shared/kernel_arguments.h.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include "shared/kernel_arguments.h"
#include "shared/light_tree.h"
#include "shared/pipeline.h"
#include "shared/records.h"
#include "shared/spectra_layout.h"
#include "shared/thermal.h"
#include "src_gpu/device/kernel.hpp"

namespace kiloband::opencl {

/// Somebody else's buffer as an argument; it must outlive the launches.
template <class T>
class BufferRef {
 public:
  BufferRef(const DeviceBuffer<T>& buffer) : buffer_(&buffer) {}
  const DeviceBuffer<T>& buffer() const { return *buffer_; }

 private:
  const DeviceBuffer<T>* buffer_;
};

#define KB_HOST_FIELD_IN(type, name) Buffer<type> name;
#define KB_HOST_FIELD_SAME(type, name) Buffer<type> name;
#define KB_HOST_FIELD_OUT(type, name) Buffer<type> name;
#define KB_HOST_FIELD_VALUE(type, name) type name;
#define KB_HOST_FIELD(group, kind, type, name) KB_HOST_FIELD_##kind(type, name)
#define KB_HOST_VISIT(group, kind, type, name) visit(name);
#define KB_HOST_COUNT(group, kind, type, name) 1

// XArguments::Of<Buffer>: an aggregate with a member per argument, Buffer<type> or the scalar, in the order of the list.
// Designated initialisers fill it: one that is forgotten is a warning in src_gpu (KILOBAND_ALL_MEMBERS), which CI takes
// for an error.
#define KB_HOST_GROUP(GROUP, Name)                                               \
  struct Name##Arguments {                                                       \
    static constexpr uint32_t kCount = KB_##GROUP##_ARGUMENTS(KB_HOST_COUNT, +); \
    template <template <class> class Buffer>                                     \
    struct Of {                                                                  \
      using Group = Name##Arguments;                                             \
      KB_##GROUP##_ARGUMENTS(KB_HOST_FIELD, ) template <class Visit>             \
      void each(const Visit& visit) const {                                      \
        KB_##GROUP##_ARGUMENTS(KB_HOST_VISIT, )                                  \
      }                                                                          \
    };                                                                           \
  };

KB_HOST_GROUP(SCENE, Scene)
KB_HOST_GROUP(SPECTRA, Spectra)
KB_HOST_GROUP(BVH, Bvh)
KB_HOST_GROUP(POOL, Pool)
KB_HOST_GROUP(QUEUE, Queue)
KB_HOST_GROUP(EVALUATION, Evaluation)
KB_HOST_GROUP(FILM, Film)
KB_HOST_GROUP(PACKING, Packing)
KB_HOST_GROUP(REPLICATES, Replicates)
KB_HOST_GROUP(AUXILIARY, Auxiliary)

/// A kernel whose parameters are these groups, in this order.
template <class... Groups>
class KernelOf {
 public:
  /// throws std::logic_error  the kernel has another number of parameters
  KernelOf(Kernel kernel) : kernel_(std::move(kernel)) { kernel_.check_count((Groups::kCount + ...)); }

  /// Sets the arguments of whole groups; they stay until set again.
  template <class... Arguments>
  void set(const Arguments&... arguments) {
    (set_group(arguments), ...);
  }

  Kernel* operator->() { return &kernel_; }

 private:
  /// The index of a group's first argument.
  template <class Group>
  static constexpr uint32_t place_of() {
    static_assert((std::is_same_v<Group, Groups> || ...), "the kernel does not take this group");
    uint32_t place = 0;
    bool found = false;
    ((found = found || std::is_same_v<Group, Groups>, place += found ? 0 : Groups::kCount), ...);
    return place;
  }
  template <class Arguments>
  void set_group(const Arguments& arguments) {
    uint32_t index = place_of<typename Arguments::Group>();
    arguments.each([&](const auto& argument) { set_one(index++, argument); });
  }
  template <class T>
  void set_one(uint32_t index, const T& argument) {
    kernel_.set_from(index, argument);
  }
  template <class T>
  void set_one(uint32_t index, const BufferRef<T>& argument) {
    kernel_.set_from(index, argument.buffer());
  }

  Kernel kernel_;
};

#define KB_HOST_GROUP_NAME(GROUP, Name) Name##Arguments
using PathKernel = KernelOf<KB_PATH_KERNEL(KB_HOST_GROUP_NAME, KB_COMMA)>;
using AuxiliaryKernel = KernelOf<KB_AUXILIARY_KERNEL(KB_HOST_GROUP_NAME, KB_COMMA)>;
using EvaluationKernel = KernelOf<KB_EVALUATION_KERNEL(KB_HOST_GROUP_NAME, KB_COMMA)>;
using FilmKernel = KernelOf<KB_FILM_KERNEL(KB_HOST_GROUP_NAME, KB_COMMA)>;
using ReplicatesKernel = KernelOf<KB_REPLICATES_KERNEL(KB_HOST_GROUP_NAME, KB_COMMA)>;

}  // namespace kiloband::opencl
