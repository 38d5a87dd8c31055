!> Eigenvalues of small symmetric matrices.
module common_jacobi
   use common_kinds, only : wp
   implicit none
   private
   public :: principal

contains

   !> Eigenvalues, left on the diagonal, and eigenvectors of a symmetric matrix by Jacobi's rotations
   pure subroutine principal(d, vectors)
      real(wp), intent(inout) :: d(3, 3)
      real(wp), intent(out) :: vectors(3, 3)   !! columns of unit length
      real(wp) :: size, theta, t, c, s, row(3)
      integer :: sweep, i, j
      vectors = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
      size = maxval(abs(d))
      do sweep = 1, 20    ! converges quadratically: five are enough
         do i = 1, 2
            do j = i + 1, 3
               if (abs(d(i, j)) <= 1.0e-16_wp * size) cycle
               theta = (d(j, j) - d(i, i)) / (2.0_wp * d(i, j))
               t = sign(1.0_wp, theta) / (abs(theta) + sqrt(theta**2 + 1.0_wp))
               c = 1.0_wp / sqrt(t**2 + 1.0_wp)
               s = t * c
               row = d(i, :)
               d(i, :) = c * row - s * d(j, :)
               d(j, :) = s * row + c * d(j, :)
               row = d(:, i)
               d(:, i) = c * row - s * d(:, j)
               d(:, j) = s * row + c * d(:, j)
               row = vectors(:, i)
               vectors(:, i) = c * row - s * vectors(:, j)
               vectors(:, j) = s * row + c * vectors(:, j)
            end do
         end do
         if (max(abs(d(1, 2)), abs(d(1, 3)), abs(d(2, 3))) <= 1.0e-15_wp * size) exit
      end do
   end subroutine principal

end module common_jacobi
