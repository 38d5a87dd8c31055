!> Integration through the thickness of a shell: where its layers lie and which part of it each stands for.
module shell_layers
   use common_kinds, only : wp
   use common_lists, only : through_gauss => shell_through_gauss, through_lobatto => shell_through_lobatto
   use common_status, only : status_ok, status_invalid_argument
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: layers_new, most_layers

   integer, parameter :: most_layers = 15

contains

   !> Gauss's points, or Lobatto's, which have one on each face; exact for the bending stiffness from 2 and 3 on
   pure subroutine layers_new(kind, count, height, share, status)
      integer(c_int), intent(in) :: kind              !! of the list shell_through
      integer(c_int), intent(in) :: count             !! 1 to 15; of Lobatto's at least 2
      real(wp), intent(out) :: height(most_layers)    !! over the middle, in thicknesses
      real(wp), intent(out) :: share(most_layers)     !! of the thickness
      integer(c_int), intent(out) :: status
      real(wp) :: x, p, slope, step
      integer :: i, j, n
      n = int(count)
      height = 0.0_wp
      share = 0.0_wp
      status = status_invalid_argument
      if (n > most_layers .or. n < merge(2, 1, kind == through_lobatto)) return
      if (kind /= through_gauss .and. kind /= through_lobatto) return
      status = status_ok
      do i = 1, n
         if (kind == through_gauss) then
            x = -cos(acos(-1.0_wp) * (real(i, wp) - 0.25_wp) / (real(n, wp) + 0.5_wp))
         else
            x = -cos(acos(-1.0_wp) * real(i - 1, wp) / real(n - 1, wp))
         end if
         do j = 1, 50      ! Newton's from Chebyshev's points: five are enough
            if (kind == through_gauss) then
               call legendre(n, x, p, slope)
               step = p / slope
            else
               if (i == 1 .or. i == n) exit
               call legendre(n - 1, x, p, slope)
               step = slope * (1.0_wp - x**2) / (2.0_wp * x * slope - real(n * (n - 1), wp) * p)
            end if
            x = x - step
            if (abs(step) < 1.0e-15_wp) exit
         end do
         height(i) = 0.5_wp * x
         if (2 * i == n + 1) height(i) = 0.0_wp
         x = 2.0_wp * height(i)
         if (kind == through_gauss) then
            call legendre(n, x, p, slope)
            share(i) = 1.0_wp / ((1.0_wp - x**2) * slope**2)
         else
            call legendre(n - 1, x, p, slope)
            share(i) = 1.0_wp / (real(n * (n - 1), wp) * p**2)
         end if
      end do
   end subroutine layers_new

   !> Legendre's polynomial and its slope (0 at the ends, where it is not required)
   pure subroutine legendre(n, x, p, slope)
      integer, intent(in) :: n
      real(wp), intent(in) :: x
      real(wp), intent(out) :: p
      real(wp), intent(out) :: slope
      real(wp) :: before, next
      integer :: k
      before = 1.0_wp
      p = x
      if (n == 0) p = 1.0_wp
      do k = 2, n
         next = (real(2 * k - 1, wp) * x * p - real(k - 1, wp) * before) / real(k, wp)
         before = p
         p = next
      end do
      slope = 0.0_wp
      if (abs(x) < 1.0_wp .and. n > 0) slope = real(n, wp) * (before - x * p) / (1.0_wp - x**2)
   end subroutine legendre

end module shell_layers
