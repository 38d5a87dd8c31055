!> The four-hinge arch: impact, geometry of the mechanism, dynamic thrust line.
module api_arch
   use, intrinsic :: iso_c_binding, only : c_double, c_int
   implicit none
   private
   public :: impact, mechanism_limits, pose, thrust_line

contains

   !> Restitution by the thesis (B.3) and by the workless-impulse projection
   subroutine impact(n, mass, centroid, inertia, joint, hinge, opposite, thesis, projection, status)
      use arch_impact, only : impact_restitution
      integer(c_int), intent(in) :: n               !! voussoirs
      real(c_double), intent(in) :: mass(n)         !! [kg]
      real(c_double), intent(in) :: centroid(2, n)  !! [m]
      real(c_double), intent(in) :: inertia(n)      !! [kg m^2]
      integer(c_int), intent(in) :: joint(4)        !! of A, B, C, D
      real(c_double), intent(in) :: hinge(2, 4)     !! [m]
      real(c_double), intent(in) :: opposite(2, 4)  !! [m]
      real(c_double), intent(out) :: thesis         !! c_v
      real(c_double), intent(out) :: projection     !! c_v
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call impact_restitution(mass, centroid, inertia, joint, hinge, opposite, thesis, projection, status)
   end subroutine impact

   !> Critical and locking rotation, and M, V', H at rest
   subroutine mechanism_limits(hinge, mass, centroid, inertia, critical, lock, m, dv, dh, status)
      use arch_four_hinge, only : four_hinge, four_hinge_new
      real(c_double), intent(in) :: hinge(2, 4)     !! [m]
      real(c_double), intent(in) :: mass(3)         !! of the links [kg]
      real(c_double), intent(in) :: centroid(2, 3)  !! [m]
      real(c_double), intent(in) :: inertia(3)      !! [kg m^2]
      real(c_double), intent(out) :: critical       !! [rad]
      real(c_double), intent(out) :: lock           !! [rad]
      real(c_double), intent(out) :: m              !! [kg m^2]
      real(c_double), intent(out) :: dv             !! [N m]
      real(c_double), intent(out) :: dh             !! [kg m]
      integer(c_int), intent(out) :: status
      type(four_hinge) :: mechanism
      real(c_double) :: half_dm
      logical :: closed
      !f2py threadsafe
      call four_hinge_new(hinge, mass, centroid, inertia, mechanism, status)
      critical = mechanism%critical
      lock = mechanism%lock
      call mechanism%coefficients(0.0_c_double, m, half_dm, dv, dh, closed)
   end subroutine mechanism_limits

   !> Displaced voussoirs of the mechanism that rocks to +x, at nt rotations
   subroutine pose(n, nt, hinge, mass, link_centroid, link_inertia, joint, centroid, q, placed, status)
      use arch_dynamic_thrust, only : voussoir_pose
      use arch_four_hinge, only : four_hinge, four_hinge_new
      use common_status, only : status_ok
      integer(c_int), intent(in) :: n                    !! voussoirs
      integer(c_int), intent(in) :: nt                   !! rotations
      real(c_double), intent(in) :: hinge(2, 4)          !! [m]
      real(c_double), intent(in) :: mass(3)              !! of the links [kg]
      real(c_double), intent(in) :: link_centroid(2, 3)  !! [m]
      real(c_double), intent(in) :: link_inertia(3)      !! [kg m^2]
      integer(c_int), intent(in) :: joint(4)             !! of A, B, C, D
      real(c_double), intent(in) :: centroid(2, n)       !! [m]
      real(c_double), intent(in) :: q(nt)                !! [rad]
      real(c_double), intent(out) :: placed(3, n, nt)    !! x, y [m], rotation [rad]
      integer(c_int), intent(out) :: status
      type(four_hinge) :: mechanism
      integer :: k
      !f2py threadsafe
      placed = 0.0_c_double
      call four_hinge_new(hinge, mass, link_centroid, link_inertia, mechanism, status)
      do k = 1, nt
         if (status /= status_ok) return
         call voussoir_pose(mechanism, joint, centroid, q(k), placed(:, :, k), status)
      end do
   end subroutine pose

   !> Dynamic thrust line of the mechanism that rocks to +x, at nt states
   subroutine thrust_line(n, nt, hinge, link_mass, link_centroid, link_inertia, mass, centroid, inertia, joint, &
                          intrados, extrados, q, v, a, horizontal, vertical, &
                          normal_force, shear, position, point, miss, status)
      use arch_dynamic_thrust, only : dynamic_thrust
      use arch_four_hinge, only : four_hinge, four_hinge_new
      use common_status, only : status_ok
      integer(c_int), intent(in) :: n                       !! voussoirs
      integer(c_int), intent(in) :: nt                      !! states
      real(c_double), intent(in) :: hinge(2, 4)             !! [m]
      real(c_double), intent(in) :: link_mass(3)            !! [kg]
      real(c_double), intent(in) :: link_centroid(2, 3)     !! [m]
      real(c_double), intent(in) :: link_inertia(3)         !! [kg m^2]
      real(c_double), intent(in) :: mass(n)                 !! [kg]
      real(c_double), intent(in) :: centroid(2, n)          !! [m]
      real(c_double), intent(in) :: inertia(n)              !! [kg m^2]
      integer(c_int), intent(in) :: joint(4)                !! of A, B, C, D
      real(c_double), intent(in) :: intrados(2, n + 1)      !! [m]
      real(c_double), intent(in) :: extrados(2, n + 1)      !! [m]
      real(c_double), intent(in) :: q(nt)                   !! [rad]
      real(c_double), intent(in) :: v(nt)                   !! [rad/s]
      real(c_double), intent(in) :: a(nt)                   !! [rad/s^2]
      real(c_double), intent(in) :: horizontal(nt)          !! [m/s^2]
      real(c_double), intent(in) :: vertical(nt)            !! [m/s^2]
      real(c_double), intent(out) :: normal_force(n + 1, nt)  !! [N]
      real(c_double), intent(out) :: shear(n + 1, nt)         !! [N]
      real(c_double), intent(out) :: position(n + 1, nt)      !! 0 intrados, 1 extrados
      real(c_double), intent(out) :: point(2, n + 1, nt)      !! [m]
      real(c_double), intent(out) :: miss(nt)                 !! [m]
      integer(c_int), intent(out) :: status
      type(four_hinge) :: mechanism
      integer :: k
      !f2py threadsafe
      normal_force = 0.0_c_double
      shear = 0.0_c_double
      position = 0.0_c_double
      point = 0.0_c_double
      miss = 0.0_c_double
      call four_hinge_new(hinge, link_mass, link_centroid, link_inertia, mechanism, status)
      do k = 1, nt
         if (status /= status_ok) return
         call dynamic_thrust(mechanism, mass, centroid, inertia, joint, intrados, extrados, q(k), v(k), a(k), &
            horizontal(k), vertical(k), normal_force(:, k), shear(:, k), position(:, k), point(:, :, k), &
            miss(k), status)
      end do
   end subroutine thrust_line

end module api_arch
