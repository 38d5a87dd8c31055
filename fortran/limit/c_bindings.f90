!> Factors of banded matrices in the C part (c/sparse/band.c), and its room for LAPACK (c/common/blas.c).
module limit_c_bindings
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: extrados_band_factor, extrados_band_solve, extrados_blas_enter, extrados_blas_leave

   interface
      function extrados_band_factor(n, width, band) bind(c) result(status)
         import :: c_double, c_int, c_int64_t
         implicit none (type, external)
         integer(c_int64_t), value, intent(in) :: n, width
         real(c_double), intent(inout) :: band(*)
         integer(c_int) :: status
      end function extrados_band_factor

      subroutine extrados_band_solve(n, width, band, x) bind(c)
         import :: c_double, c_int64_t
         implicit none (type, external)
         integer(c_int64_t), value, intent(in) :: n, width
         real(c_double), intent(in) :: band(*)
         real(c_double), intent(inout) :: x(*)
      end subroutine extrados_band_solve

      function extrados_blas_enter() bind(c) result(status)
         import :: c_int
         implicit none (type, external)
         integer(c_int) :: status
      end function extrados_blas_enter

      subroutine extrados_blas_leave() bind(c)
         implicit none (type, external)
      end subroutine extrados_blas_leave
   end interface

end module limit_c_bindings
