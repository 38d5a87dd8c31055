!> Sequentially linear analysis: softening laws by themselves, without a model.
module api_sla_laws
   use, intrinsic :: iso_c_binding, only : c_double, c_int
   implicit none
   private
   public :: teeth, band, intervals

contains

   !> Teeth of one law
   subroutine teeth(kind, e, ft, gf, h, p, exact, overshoot, room, n, modulus, strength, status)
      use sla_sawtooth, only : make_teeth
      integer(c_int), intent(in) :: kind               !! 1 linear, 2 exponential, 3 Hordijk
      real(c_double), intent(in) :: e                  !! [Pa]
      real(c_double), intent(in) :: ft                 !! [Pa]
      real(c_double), intent(in) :: gf                 !! [N/m]
      real(c_double), intent(in) :: h                  !! crack band [m]
      real(c_double), intent(in) :: p                  !! ripple half-width over ft
      integer(c_int), intent(in) :: exact              !! 1 energy-exact, 0 ripple
      integer(c_int), intent(in) :: overshoot          !! 1 first peak on the upper line, 0 at ft
      integer(c_int), intent(in) :: room
      integer(c_int), intent(out) :: n
      real(c_double), intent(out) :: modulus(room)     !! [Pa]
      real(c_double), intent(out) :: strength(room)    !! [Pa]
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call make_teeth(kind, e, ft, gf, h, p, exact /= 0, overshoot /= 0, n, modulus, strength, status)
   end subroutine teeth

   !> Largest crack band without snap-back [m]
   subroutine band(kind, e, ft, gf, h)
      use sla_sawtooth, only : largest_band
      integer(c_int), intent(in) :: kind
      real(c_double), intent(in) :: e     !! [Pa]
      real(c_double), intent(in) :: ft    !! [Pa]
      real(c_double), intent(in) :: gf    !! [N/m]
      real(c_double), intent(out) :: h
      h = largest_band(kind, e, ft, gf)
   end subroutine band

   !> Admissible multipliers of n points under the criterion r <= alpha - beta m
   subroutine intervals(n, alpha, beta, a, b, lo, hi)
      use sla_interval, only : cone_interval
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: alpha      !! [Pa]
      real(c_double), intent(in) :: beta
      real(c_double), intent(in) :: a(3, n)    !! sx, sy, txy of the constant loads [Pa]
      real(c_double), intent(in) :: b(3, n)    !! per unit multiplier [Pa]
      real(c_double), intent(out) :: lo(n)     !! lo > hi: none
      real(c_double), intent(out) :: hi(n)
      integer :: k
      !f2py threadsafe
      lo = 0.0_c_double
      hi = 0.0_c_double
      do k = 1, n
         call cone_interval(alpha, beta, a(:, k), b(:, k), lo(k), hi(k))
      end do
   end subroutine intervals

end module api_sla_laws
