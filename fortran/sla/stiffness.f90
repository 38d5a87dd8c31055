!> The stiffness matrix of the unknown displacements with its factor, which events update or which is made anew.
module sla_stiffness
   use common_kinds, only : wp
   use sla_c_bindings, only : extrados_sparse_plain, extrados_sparse_solve
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t, c_null_ptr, c_ptr
   implicit none
   private
   public :: stiffness_matrix, stiffness_solve

   type :: stiffness_matrix
      integer(c_int64_t), allocatable :: start(:), row(:)  !! (equations + 1), pattern, see sla_assembly
      real(wp), allocatable :: value(:)                    !! kept up to date where `refactor` [N/m]
      type(c_ptr) :: factor = c_null_ptr                   !! of c/sparse/ldl.c
      integer(c_int64_t) :: factor_values = 0              !! doubles of the factor
      logical :: refactor = .false.                        !! factorise at each event, to compare
   end type stiffness_matrix

contains

   !> Displacements of some forces, which they replace
   subroutine stiffness_solve(stiffness, z, status)
      type(stiffness_matrix), intent(in) :: stiffness
      real(wp), intent(inout), contiguous :: z(:, :)   !! (equations, vectors) [N] -> [m]
      integer(c_int), intent(out) :: status
      if (stiffness%refactor) then
         status = extrados_sparse_plain(stiffness%factor, stiffness%value, int(size(z, 2), c_int), z)
      else
         status = extrados_sparse_solve(stiffness%factor, int(size(z, 2), c_int), z)
      end if
   end subroutine stiffness_solve

end module sla_stiffness
