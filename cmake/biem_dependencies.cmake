# Finds MPI, Eigen and FFTW (with its MPI library); defines biem_options (flags that every
# translation unit of the package shares) and biem_fftw.
find_package(MPI REQUIRED COMPONENTS CXX)
find_package(Eigen3 3.3 REQUIRED NO_MODULE)

find_path(BIEM_FFTW_INCLUDE_DIR fftw3.h)
find_library(BIEM_FFTW_LIBRARY fftw3)
if(NOT BIEM_FFTW_INCLUDE_DIR OR NOT BIEM_FFTW_LIBRARY)
  message(FATAL_ERROR "FFTW was not found (fftw3.h: ${BIEM_FFTW_INCLUDE_DIR}, fftw3: "
    "${BIEM_FFTW_LIBRARY}). On Debian and Ubuntu: apt install libfftw3-dev. "
    "Elsewhere set CMAKE_PREFIX_PATH to the folder where FFTW is installed.")
endif()
add_library(biem_fftw INTERFACE)
target_include_directories(biem_fftw SYSTEM INTERFACE ${BIEM_FFTW_INCLUDE_DIR})
target_link_libraries(biem_fftw INTERFACE ${BIEM_FFTW_LIBRARY})

# Everything that meets an Eigen type must see the same instruction set (Eigen's alignment depends
# on it), so the flag is shared and not private.  NaN and infinity keep their meaning: the package
# tests for them, so -ffast-math is not an option here.  -Wno-(maybe-)uninitialized: GCC 12 warns of
# its own AVX-512 header.
add_library(biem_options INTERFACE)
target_compile_features(biem_options INTERFACE cxx_std_17)
target_compile_options(biem_options INTERFACE
  -Wall -Wextra -Wno-maybe-uninitialized -Wno-uninitialized -fno-math-errno -fno-trapping-math -fopenmp-simd
  $<$<BOOL:${BIEM_NATIVE}>:-march=native>)
target_compile_definitions(biem_options INTERFACE OMPI_SKIP_MPICXX=1 MPICH_SKIP_MPICXX=1)
