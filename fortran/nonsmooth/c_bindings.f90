!> Rows of factors within an envelope in the C part (c/sparse/envelope.c).
module nonsmooth_c_bindings
   use, intrinsic :: iso_c_binding, only : c_double, c_int32_t
   implicit none
   private
   public :: extrados_envelope_rows

   interface
      pure subroutine extrados_envelope_rows(rows, i, first, start, a, status) bind(c)
         import :: c_double, c_int32_t
         implicit none (type, external)
         integer(c_int32_t), value, intent(in) :: rows, i
         integer(c_int32_t), intent(in) :: first(*), start(*)
         real(c_double), intent(inout) :: a(*)
         integer(c_int32_t), intent(out) :: status
      end subroutine extrados_envelope_rows
   end interface

end module nonsmooth_c_bindings
