// Denormal numbers as zeros.
#pragma once

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace cowgpu {

/// While one lives, denormals count as zero in SSE and AVX arithmetic of this thread and of threads it starts. Rows of
/// vertices near the z axis decay through them, far below anything that matters (host/plan/moments.hpp), and each one
/// costs a hundred cycles. Does nothing on other processors.
class FlushDenormals {
public:
#if defined(__x86_64__)
  FlushDenormals() : saved_(_mm_getcsr()) {
    _mm_setcsr(saved_ | flush_to_zero | denormals_are_zero);
  }
  ~FlushDenormals() {
    _mm_setcsr(saved_);
  }
#else
  FlushDenormals() = default;
  ~FlushDenormals() {}
#endif
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

private:
#if defined(__x86_64__)
  static constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x0040;
  unsigned saved_;
#endif
};

} // namespace cowgpu
