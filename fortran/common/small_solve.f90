!> Small dense systems by LAPACK.
module common_small_solve
   use common_kinds, only : wp
   use common_status, only : status_ok, status_invalid_argument, status_singular
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: small_solve

   integer, parameter :: most_rows = 16

   interface
      subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: wp
         implicit none (type, external)
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgesv
   end interface

contains

   !> Solve a x = b for a square matrix of at most `most_rows` rows
   subroutine small_solve(a, b, status)
      real(wp), intent(inout) :: a(:, :)     !! matrix; overwritten by its factors
      real(wp), intent(inout) :: b(:)        !! right-hand side in, solution out
      integer(c_int), intent(out) :: status  !! singular; invalid_argument where a and b do not fit
      integer :: pivot(most_rows), info, n

      n = size(b)
      status = status_invalid_argument
      if (n > most_rows .or. size(a, 1) /= n .or. size(a, 2) /= n) return
      call dgesv(n, 1, a, size(a, 1), pivot, b, n, info)
      status = merge(status_ok, status_singular, info == 0)
   end subroutine small_solve

end module common_small_solve
