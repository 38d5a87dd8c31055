!> Stiffness of blocks on springs at their points of contact, as a band without symmetry, and its factors (LAPACK).
!>
!> Column j of K stands in band(:, j), row i at 2 width + 1 + i - j; the first `width` rows are room for the factors.
module limit_springs
   use common_kinds, only : wp
   use common_status, only : status_ok, status_singular
   use limit_c_bindings, only : extrados_blas_enter, extrados_blas_leave
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: lay_springs, factor_springs, solve_springs

   interface
      subroutine dgbtrf(m, n, kl, ku, ab, ldab, ipiv, info)
         import :: wp
         implicit none (type, external)
         integer, intent(in) :: m, n, kl, ku, ldab
         real(wp), intent(inout) :: ab(ldab, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgbtrf

      subroutine dgbtrs(trans, n, kl, ku, nrhs, ab, ldab, ipiv, b, ldb, info)
         import :: wp
         implicit none (type, external)
         character, intent(in) :: trans
         integer, intent(in) :: n, kl, ku, nrhs, ldab, ldb, ipiv(*)
         real(wp), intent(in) :: ab(ldab, *)
         real(wp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dgbtrs
   end interface

contains

   !> Sum of arms^T springs arms over the points, in the band
   pure subroutine lay_springs(arms, row, springs, band)
      real(wp), contiguous, intent(in) :: arms(:, :, :)     !! (most, d, points) forces on the equations of each point
      integer(c_int), contiguous, intent(in) :: row(:, :)   !! (most, points) equations of each point, 0 beyond their number
      real(wp), contiguous, intent(in) :: springs(:, :, :)  !! (d, d, points), the second index for the force
      real(wp), contiguous, intent(out) :: band(:, :)       !! (3 width + 1, equations)
      real(wp) :: force
      integer :: point, i, j, k, at, middle, most

      middle = 2 * ((size(band, 1) - 1) / 3) + 1
      band = 0.0_wp
      do point = 1, size(row, 2)
         if (all(springs(:, :, point) == 0.0_wp)) cycle
         most = count(row(:, point) > 0)
         do j = 1, most
            at = row(j, point)
            do k = 1, size(springs, 2)
               force = dot_product(arms(j, :, point), springs(:, k, point))
               do i = 1, most
                  band(middle + row(i, point) - at, at) = band(middle + row(i, point) - at, at) + force * arms(i, k, point)
               end do
            end do
         end do
      end do
   end subroutine lay_springs

   !> Factors of the band in its place
   subroutine factor_springs(band, pivot, status)
      real(wp), contiguous, intent(inout) :: band(:, :)    !! (3 width + 1, equations)
      integer(c_int), contiguous, intent(out) :: pivot(:)  !! (equations)
      integer(c_int), intent(out) :: status                !! status_singular, status_out_of_memory, else ok
      integer :: n, width, info

      n = size(band, 2)
      width = (size(band, 1) - 1) / 3
      pivot = 0
      status = extrados_blas_enter()
      if (status /= status_ok) return
      call dgbtrf(n, n, width, width, band, size(band, 1), pivot, info)
      call extrados_blas_leave()
      status = merge(status_ok, status_singular, info == 0)
   end subroutine factor_springs

   !> The x of K x = b by the factors of the band
   subroutine solve_springs(band, pivot, x, status)
      real(wp), contiguous, intent(in) :: band(:, :)      !! (3 width + 1, equations) what factor_springs left there
      integer(c_int), contiguous, intent(in) :: pivot(:)  !! (equations) of factor_springs
      real(wp), contiguous, intent(inout) :: x(:, :)      !! (equations, right-hand sides), then solutions
      integer(c_int), intent(out) :: status               !! status_out_of_memory, else ok
      integer :: n, width, info

      n = size(band, 2)
      width = (size(band, 1) - 1) / 3
      status = extrados_blas_enter()
      if (status /= status_ok) return
      call dgbtrs('N', n, width, width, size(x, 2), band, size(band, 1), pivot, x, n, info)
      call extrados_blas_leave()
      status = merge(status_ok, status_singular, info == 0)
   end subroutine solve_springs

end module limit_springs
