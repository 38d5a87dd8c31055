!> What a joint between blocks is made of, in the plane and in space.
module dem_joint
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: joint_law, brace_joints, free_mortar, spring_share

   !> A type of joint; in the plane stiffnesses and strengths are those of the area times the depth
   type :: joint_law
      real(wp) :: normal_stiffness = 0.0_wp     !! plane [N/m per m of joint], space [Pa/m]
      real(wp) :: shear_stiffness = 0.0_wp      !! the same
      real(wp) :: friction = 0.0_wp             !! coefficient
      real(wp) :: cohesion = 0.0_wp             !! of a bonded joint: plane [N per m of joint], space [Pa]
      real(wp) :: tension = 0.0_wp              !! strength of a bonded joint, the same
      real(wp) :: damping = 0.0_wp              !! stiffness-proportional, beta [s]
      real(wp) :: strength = 0.0_wp             !! in compression: plane [N per m of joint], space [Pa]; 0: corners do not crush
   end type joint_law

contains

   !> Damp joints and make mortar unbreakable; `own` keeps what they were
   subroutine brace_joints(law, damping, own, braced, status)
      type(joint_law), intent(inout) :: law(:)
      real(wp), intent(in) :: damping               !! beta, where their own is less [s]
      type(joint_law), allocatable, intent(out) :: own(:)
      logical, intent(out) :: braced                !! whether there is mortar
      integer(c_int), intent(out) :: status         !! status_out_of_memory, else ok
      real(wp), parameter :: unbreakable = 1.0e30_wp    ! far from overflow, squared and times an area too
      integer :: k, failed
      braced = any(max(law%cohesion, law%tension) > 0.0_wp)
      allocate (own(size(law)), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      own(:) = law
      law%damping = max(law%damping, damping)
      do k = 1, size(law)
         if (.not. max(law(k)%cohesion, law(k)%tension) > 0.0_wp) cycle
         law(k)%cohesion = unbreakable
         law(k)%tension = unbreakable
      end do
   end subroutine brace_joints

   !> Give mortar its own strength again
   subroutine free_mortar(law, own)
      type(joint_law), intent(inout) :: law(:)
      type(joint_law), intent(in) :: own(:)
      law%cohesion = own%cohesion
      law%tension = own%tension
   end subroutine free_mortar

   !> Share of the spring in the approach at a point since the last step, where a face that crushes is in series with it. Dashpots
   !> follow the springs: a face that crushes at a constant force is not damped
   elemental function spring_share(by_spring, by_face, open) result(share)
      real(wp), intent(in) :: by_spring             !! [m]
      real(wp), intent(in) :: by_face               !! [m]
      logical, intent(in) :: open                   !! at the point itself
      real(wp) :: share
      share = merge(0.0_wp, 1.0_wp, open)
      if (by_spring * by_face >= 0.0_wp .and. abs(by_face) > 0.0_wp) share = share * by_spring / (by_spring + by_face)
      if (by_spring * by_face < 0.0_wp .and. abs(by_face) > abs(by_spring)) share = 0.0_wp
   end function spring_share

end module dem_joint
