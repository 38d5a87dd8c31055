!> Impact of a mechanism whose hinges close: the rate of the mechanism that opens next.
module mechanism_impact
   use common_kinds, only : wp
   implicit none
   private
   public :: projected_restitution, energy_product

contains

   !> c_v by workless impulses: rate of the next mechanism over the rate at which the last one closed.
   !>
   !> Impulses that do no work on the next mechanism project the velocities before impact on its field in the
   !> kinetic-energy product; both fields are those of opening, hence the sign. The energy kept is
   !> c_v^2 <w, w> / <u, u> <= 1 by the inequality of Cauchy and Schwarz. Negative where the next mechanism
   !> would have to close further: then the impact does not start it.
   pure function projected_restitution(mass, inertia, before, after) result(c_v)
      real(wp), intent(in) :: mass(:)       !! (n) blocks [kg]
      real(wp), intent(in) :: inertia(:)    !! (n) about the centroids [kg m^2]
      real(wp), intent(in) :: before(:, :)  !! (3, n) velocity x, y, spin of the mechanism that closes, per unit rate
      real(wp), intent(in) :: after(:, :)   !! (3, n) the same of the mechanism that opens
      real(wp) :: c_v
      c_v = -energy_product(mass, inertia, before, after) / energy_product(mass, inertia, after, after)
   end function projected_restitution

   !> Kinetic-energy product of two velocity fields
   pure function energy_product(mass, inertia, u, w) result(total)
      real(wp), intent(in) :: mass(:)
      real(wp), intent(in) :: inertia(:)
      real(wp), intent(in) :: u(:, :)  !! (3, n) velocity x, y, spin
      real(wp), intent(in) :: w(:, :)
      real(wp) :: total
      integer :: k
      total = 0.0_wp
      do k = 1, size(mass)
         total = total + mass(k) * (u(1, k) * w(1, k) + u(2, k) * w(2, k)) + inertia(k) * u(3, k) * w(3, k)
      end do
   end function energy_product

end module mechanism_impact
