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
      use common_status, only : status_bad_index
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
      thesis = 0.0_c_double
      projection = 0.0_c_double
      status = status_bad_index
      if (joint(1) < 0 .or. any(joint(2:) < joint(:3)) .or. joint(4) > n) return
      call impact_restitution(mass, centroid, inertia, joint, hinge, opposite, thesis, projection, status)
   end subroutine impact

   !> Critical and locking rotation, and M, V', H at rest
   subroutine mechanism_limits(hinge, link, critical, lock, m, dv, dh, status)
      use arch_four_hinge, only : four_hinge, four_hinge_new
      real(c_double), intent(in) :: hinge(2, 4)     !! A, B, C, D [m]
      real(c_double), intent(in) :: link(4, 3)      !! mass [kg], centroid x, y [m], inertia [kg m^2] of AB, BC, CD
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
      call four_hinge_new(hinge, link(1, :), link(2:3, :), link(4, :), mechanism, status)
      critical = mechanism%critical
      lock = mechanism%lock
      call mechanism%coefficients(0.0_c_double, m, half_dm, dv, dh, closed)
   end subroutine mechanism_limits

   !> Displaced voussoirs of the mechanism that rocks to +x, at nt rotations
   subroutine pose(hinge, link, joint, n, centroid, nt, q, placed, status)
      use arch_dynamic_thrust, only : voussoir_pose
      use arch_four_hinge, only : four_hinge, four_hinge_new
      use common_status, only : status_ok
      real(c_double), intent(in) :: hinge(2, 4)          !! A, B, C, D [m]
      real(c_double), intent(in) :: link(4, 3)           !! see mechanism_limits
      integer(c_int), intent(in) :: joint(4)             !! of A, B, C, D
      integer(c_int), intent(in) :: n                    !! voussoirs
      real(c_double), intent(in) :: centroid(2, n)       !! [m]
      integer(c_int), intent(in) :: nt                   !! rotations
      real(c_double), intent(in) :: q(nt)                !! [rad]
      real(c_double), intent(out) :: placed(3, n, nt)    !! x, y [m], rotation [rad]
      integer(c_int), intent(out) :: status
      type(four_hinge) :: mechanism
      integer :: k
      !f2py threadsafe
      placed = 0.0_c_double
      call four_hinge_new(hinge, link(1, :), link(2:3, :), link(4, :), mechanism, status)
      do k = 1, nt
         if (status /= status_ok) return
         call voussoir_pose(mechanism, joint, centroid, q(k), placed(:, :, k), status)
      end do
   end subroutine pose

   !> Dynamic thrust line of the mechanism that rocks to +x, at nt states
   subroutine thrust_line(hinge, link, joint, n, voussoir, face, nt, state, &
                          normal_force, shear, position, point, miss, status)
      use arch_dynamic_thrust, only : dynamic_thrust
      use arch_four_hinge, only : four_hinge, four_hinge_new
      use common_status, only : status_ok
      real(c_double), intent(in) :: hinge(2, 4)             !! A, B, C, D [m]
      real(c_double), intent(in) :: link(4, 3)              !! see mechanism_limits
      integer(c_int), intent(in) :: joint(4)                !! of A, B, C, D
      integer(c_int), intent(in) :: n                       !! voussoirs
      real(c_double), intent(in) :: voussoir(4, n)          !! mass [kg], centroid x, y [m], inertia [kg m^2]
      real(c_double), intent(in) :: face(2, 2, n + 1)       !! intrados and extrados end of each joint [m]
      integer(c_int), intent(in) :: nt                      !! states
      !> Rotation [rad], rate [rad/s], acceleration [rad/s^2], ground acceleration to +x and up [m/s^2]
      real(c_double), intent(in) :: state(5, nt)
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
      call four_hinge_new(hinge, link(1, :), link(2:3, :), link(4, :), mechanism, status)
      do k = 1, nt
         if (status /= status_ok) return
         call dynamic_thrust(mechanism, voussoir(1, :), voussoir(2:3, :), voussoir(4, :), joint, face(:, 1, :), &
            face(:, 2, :), state(1, k), state(2, k), state(3, k), state(4, k), state(5, k), normal_force(:, k), &
            shear(:, k), position(:, k), point(:, :, k), miss(k), status)
      end do
   end subroutine thrust_line

end module api_arch
